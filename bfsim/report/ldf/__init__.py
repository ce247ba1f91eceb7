"""What an LDF makes of a memory: the map as records, tables and drawings, and what in it costs time."""
