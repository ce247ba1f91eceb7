"""Arithmetic that compilers do differently: products, powers, sums, remainders, bits."""
