"""Inlining: which calls a compiler puts the called code in place of."""
