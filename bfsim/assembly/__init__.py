"""A kernel's instructions beside its source lines: where they are, how often they ran, their costs, and the bounds of loops."""

from bfsim.assembly.counting import Counting
from bfsim.assembly.finding import KernelCode, find_code
from bfsim.assembly.listing import listed

__all__ = ["Counting", "KernelCode", "find_code", "listed"]
