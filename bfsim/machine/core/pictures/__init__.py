"""The pictures that a core takes, and what it says of them."""
