"""Conditions: tests that are split or joined."""
