"""The stages of the vision: each is pure kernels on line arrays and one task that feeds them lines."""
