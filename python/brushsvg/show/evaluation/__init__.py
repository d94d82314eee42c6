"""Evaluate a planned job: how well it will be painted, where it differs and why, and with what confidence."""
