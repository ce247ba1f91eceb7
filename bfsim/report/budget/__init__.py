"""What each stage cost each core, what bounds the frame rate, and what is left of a target."""
