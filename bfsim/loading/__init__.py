"""Firmware, kernels, boards, compilers and scenes: found by their names, imported from the user's files, or given as objects."""
