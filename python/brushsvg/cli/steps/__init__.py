"""What several commands do alike, with what a terminal needs: options, warnings, places to write to."""
