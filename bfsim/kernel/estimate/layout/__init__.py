"""Layout: the order of the blocks, hardware loops, and what branches and frames cost."""
