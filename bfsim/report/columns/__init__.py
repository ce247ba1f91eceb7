"""The records of a run as tables of plain columns, for notebooks."""
