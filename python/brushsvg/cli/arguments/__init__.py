"""Parse and check the command line. Imports nothing heavy, so a typing error is reported at once."""
