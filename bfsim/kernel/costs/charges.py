"""What a block costs: operations, each charged to its source line, and what happens only on one side of a test."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from bfsim.kernel.ir.text import Instruction, SourceLine
from bfsim.kernel.operations import COSTS, Op


class Charge(NamedTuple):
    """One operation, executed `times` per event; negative where a test moves a cost to its other side."""

    op: Op
    line: SourceLine
    issue_cclk: int
    """Cycles of one execution, without interlocks."""
    stall_cclk: int = 0
    """Interlock cycles of one execution (0 in profiles without interlocks)."""
    times: int = 1
    routine: str = ""
    """The routine of the run-time library that the operation is part of, such as "division"."""


def charge(op: Op, line: SourceLine) -> Charge:
    """Return one execution of `op` at its cost in the instruction set."""
    return Charge(op, line, COSTS[op].cclk)


def instead(side: Iterable[Charge], other: Iterable[Charge]) -> tuple[Charge, ...]:
    """Return the charges that turn the cost of `other` into that of `side`."""
    return (*side, *(each._replace(times=-each.times) for each in other))


def merged(charges: Iterable[Charge]) -> tuple[Charge, ...]:
    """Add up equal charges; those that cancel out are left out."""
    times: dict[Charge, int] = {}
    for each in charges:
        one = each._replace(times=1)
        times[one] = times.get(one, 0) + each.times
    return tuple(one._replace(times=in_all) for one, in_all in times.items() if in_all)


@dataclass(frozen=True, slots=True)
class Test:
    """Extra charges each time `value` is true, or equals `equals`: the other side of a branch."""

    value: str
    equals: int | None
    charges: tuple[Charge, ...]


class Access(NamedTuple):
    """A load or store by the costed code, in line `line`: number `number`, from 0, of those in block `label` of the IR."""

    array: str
    writes: bool
    label: str
    number: int
    line: SourceLine
    fills: bool = False
    """Whether a routine of the library makes it, by storing words."""
    may_be: bool = False
    """Whether this is only one of the arrays that the instruction may access: its address decides."""

    turn: int = 0
    among: int = 1
    """How many arrays it may be to; this one is number `turn`. [assumed] Each gets an equal part of the events."""

    def times(self, events: int) -> int:
        """Return how many of the events access its array."""
        return (events + self.turn) // self.among

    @property
    def is_counted(self) -> bool:
        """Whether each event makes this access."""
        return not (self.fills or self.may_be)


@dataclass(slots=True)
class BlockCost:
    """What one execution of a block costs: the charges of its false (or default) side, and the tests that change them.

    `nbytes` is the size of its code; a branch counts once.
    """

    charges: list[Charge] = field(default_factory=list)
    tests: list[Test] = field(default_factory=list)
    nbytes: int = 0
    accesses: list[Instruction] = field(default_factory=list)
    """Loads and stores of the IR that the code of the block makes."""
    fills: list[Instruction] = field(default_factory=list)
    """Stores of the IR that a routine of the library makes."""

    def add(self, line: SourceLine, *ops: Op) -> None:
        """Append operations of one source line, and their code."""
        self.charges.extend(charge(op, line) for op in ops)
        self.nbytes += sum(COSTS[op].nbytes for op in ops)

    def branch(self, value: str, if_true: tuple[Charge, ...], if_false: tuple[Charge, ...]) -> None:
        """Charge one side or the other, by whether `value` is true."""
        self.charges.extend(if_false)
        self.tests.append(Test(value, None, instead(if_true, if_false)))
