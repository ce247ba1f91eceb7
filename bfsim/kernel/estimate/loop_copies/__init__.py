"""Copies of parts of loops: headers in front of them, and unrolled loops."""
