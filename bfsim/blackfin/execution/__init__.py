"""Native code of the Blackfin as it runs: its memory, its calls, and how it ends."""
