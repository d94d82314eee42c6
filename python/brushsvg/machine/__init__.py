"""A plan to the text that a machine runs."""
