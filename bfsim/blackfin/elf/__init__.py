"""ELF files: what lies where in the Blackfin's memory, and of which source line code is."""
