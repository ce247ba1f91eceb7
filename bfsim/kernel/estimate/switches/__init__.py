"""Switches: chains of tests for numbers, and what becomes of them."""
