"""The views of `brushsvg preview`, with a file for each."""
