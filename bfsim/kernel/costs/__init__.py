"""What a kernel costs, as data: charges of blocks, what is counted in a run, and by which calls it is come to."""
