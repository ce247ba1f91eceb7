"""Inlining: which calls a compiler replaces by the called code."""
