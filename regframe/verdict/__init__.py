"""How far a found map can be trusted, and why."""
