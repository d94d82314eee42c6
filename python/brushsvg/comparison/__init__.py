"""Compare a painted job, in a photograph, with its target and its prediction."""
