"""The peripherals of the chip beside the cameras, and what devices at their other ends are."""
