"""Scheduling: when each operation is issued, and which share a bundle."""
