"""What the stages leave in memory for those that follow: tables of C structs, one kind of feature a file."""
