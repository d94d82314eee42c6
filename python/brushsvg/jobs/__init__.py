"""The steps from a file to plans, marks and programs, assembled in one place."""
