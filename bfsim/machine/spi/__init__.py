"""The SPI and the strategy unit at its other end."""
