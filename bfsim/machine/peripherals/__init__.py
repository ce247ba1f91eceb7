"""The peripherals of the chip besides the cameras, and the devices at their other ends."""
