"""Where straight edges of the world lie in the rectified left picture, and how far from them a firmware finds edges, lines and depth."""
