"""Kernels as C99: what a C programmer would write, for the Blackfin's compiler and for the robot's own firmware."""

from bfsim.kernel.c.program import CProgram, c_program

__all__ = ["CProgram", "c_program"]
