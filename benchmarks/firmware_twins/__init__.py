"""C twins of the firmware's hot kernels, run on the arguments that the firmware gives them."""
