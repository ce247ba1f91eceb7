"""Real pictures: which there are, and what is measured on them."""
