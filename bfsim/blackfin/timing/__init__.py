"""What code costs: instructions, waits between them, turns of loops."""
