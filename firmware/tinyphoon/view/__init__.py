"""What the firmware saw, read out for people and files: not part of the firmware on the chip."""
