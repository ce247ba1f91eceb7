"""Compiler profiles: what stands between Python source and Blackfin code, as data.

A profile names LLVM's optimisation level and the costs of the run-time library. LLVM optimises for one
fixed 32-bit target whatever the host is, so that the same source costs the same cycles everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass

# A plain 32-bit machine with multiply and divide: 32-bit pointers as on the Blackfin, no vectors, and LLVM
# knows it on every host.
GENERIC_TRIPLE, GENERIC_FEATURES = "riscv32-unknown-elf", "+m"


@dataclass(frozen=True, slots=True)
class CompilerProfile:
    """How a compiler for the Blackfin treats a kernel. `divide_cclk` includes the call."""

    name: str
    speed_level: int
    divide_cclk: int
    saved_registers: int
    """Registers that a function with calls in it saves and restores, one cycle each."""


VDSP_O2 = CompilerProfile(
    name="vdsp-O2",
    speed_level=2,
    divide_cclk=52,     # [VLIB] VisualDSP++ run-time library, ___div32: 25 to 91 cycles, average 52
    saved_registers=6,  # [assumed] R4-R7 and two P registers
)  # fmt: skip
