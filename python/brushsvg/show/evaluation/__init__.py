"""How well it will be painted, why not, and with what confidence."""
