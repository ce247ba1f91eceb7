"""Redundancies: values computed or loaded on a path where they are already available, or not needed."""
