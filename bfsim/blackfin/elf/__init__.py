"""ELF files: what lies where in the Blackfin's memory, and which source lines code comes from."""
