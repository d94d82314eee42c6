"""Commands for brushes: charts, calibration, comparison."""
