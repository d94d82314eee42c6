"""Curves, arcs, polylines and rings, whatever they are of."""
