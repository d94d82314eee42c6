"""Fit brushes to measurements and painted marks."""
