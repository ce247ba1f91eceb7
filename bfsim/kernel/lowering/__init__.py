"""Lowering: from optimised or plain LLVM IR to the Blackfin operations that a C compiler would emit, and their cost."""
