"""Which routines of a program call which others, and with which of their own arrays."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.reading import KERNEL_CALL
from bfsim.kernel.ir.text import Routine

POINTER = re.compile(r"\bptr (?:\w+ )*(%[\w.$-]+)")


class RoutineCall(NamedTuple):
    """A call of a routine; `arrays`: its array parameters, each with the caller's parameter that is passed for it."""

    callee: str
    arrays: tuple[tuple[str, str], ...]


def calls_of(routines: Sequence[Routine]) -> dict[str, tuple[RoutineCall, ...]]:
    """Return the calls that each routine makes of the others, in the order of its text."""
    parameters = {each.symbol: [name[1:] for name in each.parameters] for each in routines}
    return {each.symbol: tuple(_calls(each, parameters)) for each in routines}


def _calls(routine: Routine, parameters: Mapping[str, Sequence[str]]) -> Iterator[RoutineCall]:
    flow = ControlFlow(routine)
    own = set(parameters[routine.symbol])
    for block in routine.blocks:
        for each in block.instructions:
            found = KERNEL_CALL.search(each.row)
            if found and found[1] in parameters:
                pointers = set(POINTER.findall(each.text))
                pairs = zip(parameters[found[1]], each.operands, strict=True)
                roots = [(name, flow.root(operand)[1:]) for name, operand in pairs if operand in pointers]
                yield RoutineCall(found[1], tuple((name, root) for name, root in roots if root in own))
