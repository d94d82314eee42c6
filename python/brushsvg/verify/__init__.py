"""Read programs back and compare them with plans and regenerated programs."""
