"""A core's clock, and where its cycles go."""
