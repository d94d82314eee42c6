"""The way from a file to plan, marks and programs, put together once."""
