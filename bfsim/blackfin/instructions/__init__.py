"""The instruction table: how instructions are encoded and written, and what each does."""
