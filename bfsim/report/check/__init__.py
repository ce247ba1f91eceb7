"""Comparing runs with the limits in a baseline file: what is measured, what is allowed, verdicts and reasons."""
