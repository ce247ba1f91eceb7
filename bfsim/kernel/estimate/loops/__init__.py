"""Loops: what changes in them and by how much, how often they iterate, and which ones an instruction or a call replaces."""
