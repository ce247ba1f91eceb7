"""Redundancies: what is computed or loaded on a way where it is there already, or not needed."""
