"""Files for viewers that others make: Perfetto, speedscope, Foxglove."""
