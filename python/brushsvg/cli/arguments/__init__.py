"""What was typed, parsed and checked. Nothing heavy is imported: a typing error is told at once."""
