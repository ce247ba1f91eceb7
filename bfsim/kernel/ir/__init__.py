"""LLVM IR as data: read, written, and its control flow; what every pass of the estimate stands on."""
