"""A picture to marks in mm: markers, flattening, edges."""
