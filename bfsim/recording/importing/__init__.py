"""From pictures in files to a recording: image files, raw frames and videos, and which of them were taken at once."""
