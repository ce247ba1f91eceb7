"""What was seen, drawn over the pictures."""
