"""Kernels' C, and C and assembler of users, through the Blackfin's compiler: object code, kept by what it was made of."""
