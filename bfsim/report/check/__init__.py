"""Holding runs against the limits in a baseline file: what is measured, what is allowed, what came out, and why."""
