"""A drawing to the strokes that paint it."""
