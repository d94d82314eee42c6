"""Cells: a machine, its limits and the place of its paper."""
