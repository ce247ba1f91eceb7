"""The stages of the vision: each consists of pure kernels on line arrays and a task that feeds them lines."""
