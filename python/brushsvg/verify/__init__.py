"""Read robot programs back into plans and compare them with the expected plans and programs."""
