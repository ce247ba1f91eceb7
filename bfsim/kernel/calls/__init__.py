"""The input and output of a kernel's call: arguments, `Work`, and the access trace."""
