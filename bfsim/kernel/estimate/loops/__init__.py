"""Loops: what changes in them and by how much, how often they iterate, and those that an instruction or a call replaces."""
