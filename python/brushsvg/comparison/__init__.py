"""A job that was painted, in a photograph, held against what was wanted and what was predicted."""
