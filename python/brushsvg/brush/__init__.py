"""The tool: brush files, their laws and footprints, how sure they are."""
