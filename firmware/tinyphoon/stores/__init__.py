"""Results of the stages in memory, for later stages: tables of C structs, one file for each kind of feature."""
