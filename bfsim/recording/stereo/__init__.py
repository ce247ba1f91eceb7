"""Whether stereo frames are what the matching of edges needs: in the right order, and row beside row."""
