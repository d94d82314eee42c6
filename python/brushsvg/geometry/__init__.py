"""Curves and arcs, whatever they are of."""
