"""Files for other people's viewers: Perfetto, speedscope, Foxglove."""
