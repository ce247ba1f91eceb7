"""How cores meet each other: semaphores, spin locks, interrupts, and buffers that they hand over."""
