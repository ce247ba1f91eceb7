"""What a run left behind as JSON, what was seen included; and read back."""
