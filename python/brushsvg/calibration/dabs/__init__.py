"""Fit a brush to the outlines of dabs."""
