"""What a kernel call costs beside its instructions: conflicts in L1, instruction fetch, caches; and its records."""
