"""Commands for drawings and their programs."""
