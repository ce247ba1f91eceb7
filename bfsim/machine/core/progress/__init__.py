"""How a core's firmware gets on against the simulated time: in step with it, or ahead of it."""
