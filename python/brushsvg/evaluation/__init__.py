"""How well it will be painted, why not, and how sure that is."""
