"""Kernels that are object code: translated to native code, counted by source line and class of operation, and called."""
