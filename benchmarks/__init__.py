"""How fast and how right the simulator is. Slow; not part of the tests."""
