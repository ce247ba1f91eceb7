"""Kernels as C99: what a C programmer would write, for the Blackfin's compiler and for the robot's own firmware."""

from bfsim.kernel.c.program import HEADER, CProgram, c_program
from bfsim.kernel.c.statements import Place, in_python

__all__ = ["HEADER", "CProgram", "Place", "c_program", "in_python"]
