"""Fit a brush to measured numbers."""
