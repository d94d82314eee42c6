"""A brush from the outlines of dabs."""
