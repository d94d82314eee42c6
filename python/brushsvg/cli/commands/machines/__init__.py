"""Commands for a machine before its first job."""
