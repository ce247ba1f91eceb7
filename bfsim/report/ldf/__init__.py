"""The memory that an LDF makes: its map as records, tables and drawings, and what costs time in it."""
