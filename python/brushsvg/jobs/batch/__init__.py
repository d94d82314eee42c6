"""Many drawings: each converted on its own, wherever; what is done stays done."""
