"""The strategy unit at the other end of the SPI, a device that is no part of the firmware on the chip."""
