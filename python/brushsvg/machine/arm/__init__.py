"""Joints of an arm while it paints: their limits and speeds, and places for the paper within their reach."""
