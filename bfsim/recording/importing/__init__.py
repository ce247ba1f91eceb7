"""From picture files to a recording: image files, raw frames and videos, and which pictures were taken together."""
