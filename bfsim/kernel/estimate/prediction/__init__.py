"""Branch prediction: how likely each side of a test is guessed to be, and so how often each block runs."""
