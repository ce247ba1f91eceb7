"""What a kernel costs, as data: the charges of blocks, what is counted in a run, and the call paths that lead to it."""
