"""What the firmware saw, read out for people and files: no part of the firmware on the chip."""
