"""Turn a drawing into the plan of one brush and cell, with warnings."""
