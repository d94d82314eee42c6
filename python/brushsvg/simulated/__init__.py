"""Simulation of a studio without a robot: its machine, brush and camera have small errors."""
