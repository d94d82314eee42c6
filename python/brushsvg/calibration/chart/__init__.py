"""Charts for the calibration of a brush: layout, file and page to print."""
