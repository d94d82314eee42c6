"""Measurements and painted marks to a brush."""
