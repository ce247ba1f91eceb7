"""What differs between two runs, and what makes the difference: from stages down to the causes in a source line."""
