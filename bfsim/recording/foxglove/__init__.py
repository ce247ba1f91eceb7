"""What was seen, as an MCAP file that Foxglove and rerun draw."""
