"""Switches: chains of tests for numbers, and what they become."""
