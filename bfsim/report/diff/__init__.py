"""What differs between two runs, and what causes the difference: from stages down to the causes in a source line."""
