"""A brush from measured numbers."""
