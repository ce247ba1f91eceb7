"""Conditions: tests that are split or made one."""
