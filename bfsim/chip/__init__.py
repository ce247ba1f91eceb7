"""The hardware as data: chips, boards, SDRAM parts, sensors, the memory map, and pure functions on them."""
