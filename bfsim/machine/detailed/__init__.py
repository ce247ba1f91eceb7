"""The detailed mode: the same buses with an event per transaction. It is slow, and the fast mode is checked against it."""
