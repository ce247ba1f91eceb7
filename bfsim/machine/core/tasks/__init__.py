"""The tasks of a core's firmware, one at a time: its main loop, its handlers, and their calls of kernels."""
