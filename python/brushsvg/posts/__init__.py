"""One robot language per file: moves -> text."""
