"""What ran on what: code, configuration, digests."""
