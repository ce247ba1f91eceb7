"""What a run is made of: its inputs, how its kernels are built, what it depends on and assumes, and its recorded work."""
