"""The buffers of a core by name, and its rings of lines."""
