"""Instruction selection: the operations by which a Blackfin computes the optimised IR."""
