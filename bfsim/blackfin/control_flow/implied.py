"""Counts that need no counter: a block is executed as often as control takes all the edges that lead to it.

They are worked out when the code is left, which takes less time than storing another count at every execution. A short
block without a store can also become instructions without a branch around them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from bfsim.blackfin.control_flow.blocks import DIRECT, Code, does, is_clocked
from bfsim.blackfin.control_flow.flow import Edge, Way, edges


class Into(NamedTuple):
    """An edge into a block, taken as often as the block `before` is executed, or as its branch is `taken` or not taken."""

    before: int
    taken: bool | None = None


@dataclass(frozen=True, slots=True)
class Implied:
    """The block at `block` is executed as often as control takes all of these edges together."""

    block: int
    ways: tuple[Into, ...]

    @property
    def needs(self) -> set[int]:
        """The blocks whose own counts are needed. A taken branch has a separate count."""
        return {each.before for each in self.ways if each.taken is not True}


def implied(code: Code) -> list[Implied]:
    """Return the blocks whose counts follow from others, each after all those whose counts it needs.

    There are none if code goes on after an event or asks for its cycles: then counts must be right in between, too.
    """
    instructions = (each for block in code.blocks.values() for each in block.instructions)
    if code.resumes or any(map(is_clocked, instructions)):
        return []
    ways: dict[int, list[Into]] = {}
    known = code.blocks.keys() - set(code.targets)
    for each in edges(code):
        if _is_alone(code, each):
            ways.setdefault(each.target, []).append(_into(code, each))
        else:
            known.discard(each.target)
    for block in code.blocks.values():
        for target in block.calls:
            if code.is_loop_end(block.instructions[-1].address):
                known.discard(target)
            ways.setdefault(target, []).append(Into(block.start))
    return _ordered({each: Implied(each, tuple(ways[each])) for each in sorted(known & ways.keys())})


def _is_alone(code: Code, edge: Edge) -> bool:
    """Whether an edge's count is known: not at the end of a hardware loop, nor after a call or a computed jump."""
    last = code.blocks[edge.source].instructions[-1]
    return not code.is_loop_end(last.address) and (
        edge.way is Way.FALLS or (edge.way is Way.JUMPS and does(last) in DIRECT)
    )


def _into(code: Code, edge: Edge) -> Into:
    return Into(edge.source, edge.way is Way.JUMPS if code.blocks[edge.source].branches else None)


def _ordered(found: Mapping[int, Implied]) -> list[Implied]:
    """Put each after those that it needs. If they need each other in a circle, one of it is left out: it is counted."""
    done: dict[int, Implied | None] = {}
    for start in found:
        path = {start: None}
        while path:
            at = next(reversed(path))
            open_ = [each for each in found[at].needs if each in found and each not in done]
            if at in done or not open_:
                done.setdefault(at, found[at])
                path.popitem()
            elif (need := min(open_)) in path:
                done[need] = None
            else:
                path[need] = None
    return [each for each in done.values() if each]
