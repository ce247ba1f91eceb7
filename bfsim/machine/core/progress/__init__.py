"""How a core's firmware advances relative to simulated time: in step with it, or ahead of it."""
