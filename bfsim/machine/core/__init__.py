"""A core: its main loop, its clock, where its cycles go, and what it waits for."""
