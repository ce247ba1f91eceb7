"""The translator: object code → one native function that counts what it does."""
