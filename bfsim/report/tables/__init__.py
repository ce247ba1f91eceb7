"""What the tables of all reports have in common."""
