"""Arithmetic that compilers do in another way: products, powers, sums, remainders, bits."""
