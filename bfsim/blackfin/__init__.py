"""The Blackfin processor: object code → what lies where in its memory, and which source line it is of."""
