"""Python twins of C kernels that GCC compiled for the Blackfin and the GNU simulator ran: same outputs, bit for bit."""
