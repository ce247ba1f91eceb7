"""Whether stereo frames suit the matching of edges: left and right in order, and in the same rows."""
