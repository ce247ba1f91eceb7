"""Registers: which bank each value is in, what does not fit, and what that costs."""
