"""Marks, drawings and programs to look at."""
