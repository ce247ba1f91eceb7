"""Loads and stores: which are moved, joined, split, or carried in registers."""
