"""Where in the pictures the time went."""
