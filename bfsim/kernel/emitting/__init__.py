"""Typed tree → LLVM IR, as plain as code at -O0."""
