"""LLVM IR → machine code for this host, with counters, guards and reports of accesses."""
