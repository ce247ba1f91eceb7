"""A kernel's instructions beside its source lines: where its code is, how often it ran, what each costs and what bounds its loops."""

from bfsim.assembly.counting import Counting
from bfsim.assembly.finding import KernelCode, find_code
from bfsim.assembly.listing import listed

__all__ = ["Counting", "KernelCode", "find_code", "listed"]
