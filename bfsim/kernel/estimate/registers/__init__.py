"""Registers: the bank of each value, the values that do not fit, and what that costs."""
