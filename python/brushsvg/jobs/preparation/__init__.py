"""A drawing to the plan of one brush and cell, with its warnings."""
