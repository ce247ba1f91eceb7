"""What tests say of values, on the path to where they are used."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import INVERTED, SWAPPED, predicate

Said = tuple[str, str, str]
"""What a test says: a value, a relation, and another value."""


def said_before(flow: ControlFlow, label: str) -> Iterator[Said]:
    """Yield what the tests on the only path to a block say, the last one first."""
    seen = {label}
    while len(before := flow.predecessors[label]) == 1 and before[0] not in seen:
        yield from said_between(flow, before[0], label)
        label = before[0]
        seen.add(label)


def said_between(flow: ControlFlow, label: str, behind: str) -> Iterator[Said]:
    """Yield what the test at the end of a block says if it leads on to `behind`."""
    end, ways = flow.blocks[label].terminator, flow.blocks[label].successors
    test = flow.instruction(end.operands[0]) if end.opcode == "br" and end.operands else None
    if test is not None and test.opcode == "icmp" and len(set(ways)) == 2:
        relation = predicate(test) if ways[0] == behind else INVERTED[predicate(test)]
        one, other = test.operands[:2]
        yield one, relation, other
        yield other, SWAPPED[relation], one
