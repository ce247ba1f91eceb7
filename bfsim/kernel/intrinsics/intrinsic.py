"""What is known of an intrinsic: a function of the kernel language that is an instruction of the Blackfin, or a few."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from inspect import signature

from bfsim.blackfin.instructions.operands import Operand
from bfsim.kernel.operations import Op
from bfsim.kernel.types import PAIR, IntType, PairType

RESULT, LOWER = "R4", "R5"
"""Registers of a row's result; R5 has the lower one of two. A multiplier writes whole words to even registers."""


@dataclass(frozen=True, slots=True)
class Step:
    """An instruction: its row in the instruction table (`bfsim.blackfin.instructions.forms`), by what it does and its operands."""

    does: str
    operands: Mapping[str, Operand]
    op: Op


@dataclass(frozen=True, eq=False)
class Intrinsic:
    """A row. `python` has the names of it and of its parameters, and says what it computes, in Python's integers.

    `takes`: types of its parameters; of a narrow one, only its own bits count. `gives`: the type of its result; a pair
    is two words. `steps`: what the Blackfin executes, with the parameters in `registers` before. `c`: an expression of
    C99 for other processors, with the functions of `halves.h`.
    """

    python: Callable[..., object]
    takes: tuple[IntType, ...]
    gives: IntType | PairType
    steps: tuple[Step, ...]
    c: str
    registers: tuple[str, ...] = ("R0", "R1", "R2")

    def __repr__(self) -> str:
        """Return the name, which stands for it in the text of a kernel."""
        return self.name

    @property
    def name(self) -> str:
        """Its name in kernels and in C."""
        return self.python.__name__

    @property
    def symbol(self) -> str:
        """Its name in LLVM's IR."""
        return f"{PREFIX}{self.name}"

    @cached_property
    def parameters(self) -> tuple[str, ...]:
        """Names of its parameters."""
        return tuple(signature(self.python).parameters)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Registers of its parameters."""
        return self.registers[: len(self.takes)]

    @property
    def outputs(self) -> tuple[str, ...]:
        """Registers of its results."""
        return (RESULT, LOWER) if self.gives is PAIR else (RESULT,)

    @property
    def ops(self) -> tuple[Op, ...]:
        """Operations that it costs."""
        return tuple(each.op for each in self.steps)


PREFIX = "bfsim.intrinsic."
