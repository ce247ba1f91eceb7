"""What a call of a kernel takes and what it leaves: arguments, `Work`, and the access trace."""
