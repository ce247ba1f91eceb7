"""Counts that need not be made: a block to which only one way leads is executed as often as control goes that way.

They are worked out when the code is left, which takes less than to store one more count each time, and a short block without a store
can become instructions without a branch around them.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.blackfin.blocks import CALLS, DIRECT, Code, does, is_clocked
from bfsim.blackfin.flow import Edge, Way, edges


@dataclass(frozen=True, slots=True)
class Implied:
    """The block at `block` is executed as often as the one at `before`; with `taken`, as often as the branch there is taken, or is not."""

    block: int
    before: int
    taken: bool | None


def implied(code: Code) -> list[Implied]:
    """Return the blocks whose counts follow from those of the block before, which comes first if it is one of them.

    There are none where code goes on behind an event or asks for its cycles: counts must be right in between there.
    """
    instructions = (each for block in code.blocks.values() for each in block.instructions)
    if code.resumes or any(map(is_clocked, instructions)):
        return []
    ways: dict[int, list[Edge]] = {}
    for each in edges(code):
        ways.setdefault(each.target, []).append(each)
    entered = {*code.targets, *_called(code)}
    found = {
        target: _implied(code, into[0])
        for target, into in ways.items()
        if len(into) == 1 and target not in entered and _is_alone(code, into[0])
    }
    ordered: dict[int, Implied] = {}
    for start in found:
        chain, at = list[Implied](), start
        while at in found and at not in ordered:
            chain.append(found[at])
            at = found[at].before
        ordered |= {each.block: each for each in reversed(chain)}
    return list(ordered.values())


def _called(code: Code) -> set[int]:
    """Return where functions begin that are called; no way in `edges` leads there."""
    ends = (each.instructions[-1] for each in code.blocks.values() if each.instructions)
    return {int(each.operands["t"]) for end in ends for each in end.operations if does(end) in CALLS & DIRECT}


def _is_alone(code: Code, edge: Edge) -> bool:
    """Whether it is known how often control goes a way: not at the end of a hardware loop, nor behind a call or a computed jump."""
    last = code.blocks[edge.source].instructions[-1]
    return not code.is_loop_end(last.address) and (
        edge.way is Way.FALLS or (edge.way is Way.JUMPS and does(last) in DIRECT)
    )


def _implied(code: Code, edge: Edge) -> Implied:
    branches = code.blocks[edge.source].branches
    return Implied(edge.target, edge.source, (edge.way is Way.JUMPS) if branches else None)
