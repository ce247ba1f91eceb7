"""The estimate of code that no compiler optimised: GCC at -O0."""
