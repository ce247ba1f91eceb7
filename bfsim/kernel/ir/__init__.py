"""LLVM IR as data: read, written, and its control flow; the base of every pass of the estimate."""
