"""What a core's firmware does, one thing after the other: its main loop, its handlers, their calls of kernels."""
