"""The choices that a user makes for a drawing, and their checks."""
