"""Choices between values: if-conversion, minima and maxima, conditional moves."""
