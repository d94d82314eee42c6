"""Curves, arcs, polylines and rings."""
