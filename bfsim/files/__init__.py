"""Files: the cache on disk, files that are written completely or not at all, and files from users."""
