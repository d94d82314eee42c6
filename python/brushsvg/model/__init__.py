"""The tool: brush files, their laws, footprints and confidence."""
