"""The cameras and their PPIs: pictures arrive word by word in frame buffers, one pair at a time."""
