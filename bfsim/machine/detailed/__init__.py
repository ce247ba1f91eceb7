"""The detailed mode: the same buses with an event per transaction. Slow, and the judge of the fast mode."""
