"""`brushsvg setup`: programs before the first job, and the extension for Inkscape."""
