"""Copies of loops' parts: headers in front of them, and loops that are written out."""
