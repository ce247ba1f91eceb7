"""The SPI of the board, and what a device at its other end is."""
