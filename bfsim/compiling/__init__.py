"""Object code that the Blackfin's compiler makes of kernels' C and of users' C and assembler, kept by what it is made from."""
