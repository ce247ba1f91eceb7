"""How GCC's code calls functions: arguments in R0 to R2 and on the stack, the result in R0.

[GCC] The caller leaves room for the three registers below the arguments on the stack.
"""

from __future__ import annotations

STACK, STACK_BYTES = 0xFFB00000, 4096
"""[HRM] The scratchpad memory of a core."""
WORD_BYTES = 4
REGISTERS = ("R0", "R1", "R2")
"""Have the first arguments."""
RESULT = "R0"
KEPT = ("R4", "R5", "R6", "R7", "P3", "P4", "P5", "FP", "SP")
"""[GCC] Registers that a function leaves as they were."""
