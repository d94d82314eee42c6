"""`brushsvg preview`, a file for each view."""
