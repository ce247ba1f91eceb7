"""Instruction selection: what of the optimised IR a Blackfin computes, and by which operations."""
