"""Files: the cache on disk, what is written as a whole or not at all, and what users give to read."""
