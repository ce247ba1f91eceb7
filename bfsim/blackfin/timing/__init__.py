"""What code costs: instructions, waits between them, iterations of loops."""
