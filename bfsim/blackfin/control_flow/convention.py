"""How GCC's code calls functions: arguments in R0 to R2 and on the stack, the result in R0.

[GCC] The caller leaves room for the three registers below the arguments on the stack.
"""

from __future__ import annotations

from dataclasses import dataclass

STACK, STACK_BYTES = 0xFFB00000, 4096
"""[HRM] The scratchpad memory of a core."""
REGISTERS = ("R0", "R1", "R2")
"""They have the first arguments."""
RESULT = "R0"
KEPT = ("R4", "R5", "R6", "R7", "P3", "P4", "P5", "FP", "SP")
"""[GCC] Registers that a function leaves as they were."""
GIVEN = frozenset({*REGISTERS, "SP", "FP", "RETS", "PC", "SYSCFG", "CLOCK", "CYCLES_OFFSET", "CYCLES2"})
"""Registers that are set before code is called as a function. Others are then 0, also the lengths of circular buffers [GCC]."""


@dataclass(frozen=True, slots=True)
class Contract:
    """What holds for code that is called as one function, with `GIVEN`.

    `read`: registers that are read when it has returned, and that need not be 0 when it is called. `is_trusted`: the
    compiler made it from a kernel in Python, so it returns to its caller and its accesses are aligned. Other code is
    left where it does not keep to that.
    """

    read: frozenset[str]
    is_trusted: bool
