"""Re-timing: what the cores of a run did, without its time, and cores that do it again on other hardware."""
