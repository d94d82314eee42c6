"""`brushsvg setup`: programs before the first job, and the Inkscape extension."""
