"""Steps that several commands share: options, warnings, output files."""
