"""The cameras and their PPIs: pictures arrive word by word in frame buffers, a pair at a time."""
