"""The cost of a kernel call besides its instructions: conflicts in L1, instruction fetch, caches; and its records."""
