"""How well the firmware sees: what it finds beside what OpenCV finds in the same pictures."""
