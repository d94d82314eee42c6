"""Parse and check the command line.

Nothing heavy is imported here, so that usage errors are reported at once.
"""
