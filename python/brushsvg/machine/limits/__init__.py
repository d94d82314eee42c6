"""The limits of a machine and its sheet: places, speeds, vessels and paint."""
