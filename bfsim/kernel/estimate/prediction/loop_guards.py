"""Loop guards: a test that decides whether an inner loop is reached is guessed to fail [predict_loops in predict.cc of GCC 12].

If the other side of such a test only leaves the loop around, the test before it decides, and so on
[predict_paths_for_bb].
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.ir.control_flow import ControlFlow, Loop


def loop_guards(flow: ControlFlow) -> Iterator[tuple[str, str]]:
    """Yield the edges that lead to loops, if another path goes round the loop around without them."""
    for around in flow.loops:
        for loop in around.inner:
            yield from guards_of(flow, loop, around)


def guards_of(flow: ControlFlow, loop: Loop, around: Loop) -> Iterator[tuple[str, str]]:
    """Yield the edges that lead to one loop in another."""
    first = _first_of(flow, loop)
    if first not in flow.dominators[around.latch]:
        edges = _leading_to(flow, first, around, {first})
        yield from (edge for edge in edges if edge[0] not in loop.blocks)


def _leading_to(flow: ControlFlow, first: str, around: Loop, seen: set[str]) -> Iterator[tuple[str, str]]:
    """Yield the edges from blocks that may pass `first` by to blocks that may not."""
    for label in flow.order:
        if first not in flow.post_dominators[label]:
            continue
        for source in flow.predecessors[label]:
            if first in flow.post_dominators[source]:
                continue
            ways = set(flow.blocks[source].successors) - {label}
            if any(way in around.blocks and first not in flow.post_dominators[way] for way in ways):
                yield source, label
            elif source not in seen:
                seen.add(source)
                yield from _leading_to(flow, source, around, seen)


def _first_of(flow: ControlFlow, loop: Loop) -> str:
    """Where the source begins a loop: at the test that decides whether it is entered (a copy of one that ends it), if there is one."""
    ends = {flow.blocks[label].terminator.line for label in flow.exits(loop)}
    found, label = loop.header, _dominator(flow, loop.header)
    while label:
        if len(set(flow.blocks[label].successors)) > 1:
            if flow.blocks[label].terminator.line not in ends:
                break
            found = label
        label = _dominator(flow, label)
    return found


def _dominator(flow: ControlFlow, label: str) -> str:
    """The last block that every path to another one passes; none for the first one."""
    before = flow.dominators[label] - {label}
    return max(before, key=lambda each: len(flow.dominators[each]), default="")
