"""A program back to a plan, held against what it should be."""
