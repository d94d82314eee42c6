"""Turn a plan into a program for a machine."""
