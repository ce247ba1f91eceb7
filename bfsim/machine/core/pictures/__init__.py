"""The pictures that a core takes, and what it publishes about them."""
