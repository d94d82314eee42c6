"""A known brush, updated by a painted job."""
