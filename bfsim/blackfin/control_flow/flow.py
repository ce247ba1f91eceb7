"""How control goes from block to block, and the loops that this makes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum, auto

from bfsim.blackfin.control_flow.blocks import CALLS, COMPUTED, DIRECT, NEVER_ON, Block, Code, does


class Way(Enum):
    """How control comes to a block."""

    FALLS = auto()
    """From the instruction before it, without a cycle in between."""
    REPEATS = auto()
    """From the end of a hardware loop to its start, without a cycle in between, too."""
    JUMPS = auto()
    RETURNS = auto()
    """From a call at the end of the block before it."""


@dataclass(frozen=True, slots=True)
class Edge:
    """A way from the block at `source` to that at `target`."""

    source: int
    target: int
    way: Way


@dataclass(frozen=True, slots=True)
class Loop:
    """Blocks, by their addresses, from which control comes back to the one at `head`. `is_hardware`: by LC, LT and LB.

    `depth`: the number of loops that it is in, itself included.
    """

    head: int
    blocks: frozenset[int]
    is_hardware: bool
    depth: int


def edges(code: Code, within: Iterable[int] | None = None) -> list[Edge]:
    """Return the edges between the blocks of code, or between those `within` it.

    Control goes on after a call. A computed jump may lead to every target of computed jumps `within`, except where
    calls return.
    """
    blocks = set(code.blocks if within is None else within)
    targets = [each for each in code.targets if each in blocks - code.resumed]
    return [
        each
        for start in sorted(blocks)
        for each in dict.fromkeys(_edges(code, code.blocks[start], targets))
        if each.target in blocks
    ]


def _edges(code: Code, block: Block, targets: Sequence[int]) -> Iterator[Edge]:
    if not block.instructions:
        return
    last = block.instructions[-1]
    what, start = does(last), block.start
    if what in CALLS:
        yield Edge(start, block.end, Way.RETURNS)
        return
    if what in DIRECT:
        yield Edge(start, int(last.operations[0].operands["t"]), Way.JUMPS)
    elif what in COMPUTED and not block.returns:
        yield from (Edge(start, each, Way.JUMPS) for each in targets)
    for counter in (1, 0):
        for each in sorted(code.loop_starts.get((last.address, counter), ())):
            yield Edge(start, each, Way.REPEATS)
    if what not in NEVER_ON and not block.refused:
        yield Edge(start, block.end, Way.FALLS)


def is_closed(code: Code) -> bool:
    """Whether control comes in at one entry alone, and goes to a computed address only to return from a function."""
    return len(code.entries) == 1 and all(
        each.returns or not each.is_computed for each in code.blocks.values()
    )


def returns(code: Code) -> Mapping[int, frozenset[int]]:
    """Return where each block that returns from a function goes: after the calls that name the function."""
    onward = _onward(edges(code))
    behind: dict[int, set[int]] = {}
    for block in code.blocks.values():
        for target in block.calls:
            behind.setdefault(target, set()).add(block.end)
    found: dict[int, frozenset[int]] = {}
    for function, sites in behind.items():
        for each in _reached(onward, function):
            if code.blocks[each].returns:
                found[each] = found.get(each, frozenset()) | sites
    return found


def loops(found: Sequence[Edge], entry: int) -> list[Loop]:
    """Return the natural loops of a routine that is entered at `entry`, outer ones before those in them."""
    before = dominators(found, entry)
    bodies: dict[int, set[int]] = {}
    hardware: set[int] = set()
    for each in found:
        if each.target in before.get(each.source, ()):
            bodies.setdefault(each.target, {each.target}).update(_body(found, each))
            if each.way is Way.REPEATS:
                hardware.add(each.target)
    return [
        Loop(head, frozenset(body), head in hardware, sum(body <= other for other in bodies.values()))
        for head, body in sorted(bodies.items(), key=lambda each: (-len(each[1]), each[0]))
    ]


def dominators(found: Sequence[Edge], entry: int) -> Mapping[int, frozenset[int]]:
    """Return for each block that can be reached the blocks that control must have passed to come to its end."""
    sources: dict[int, set[int]] = {}
    for each in found:
        sources.setdefault(each.target, set()).add(each.source)
    reached = _reached(_onward(found), entry)
    known = {each: frozenset({each}) if each == entry else frozenset(reached) for each in reached}
    changed = True
    while changed:
        changed = False
        for block in sorted(reached - {entry}):
            new = frozenset.intersection(*(known[each] for each in sources[block] & reached)) | {block}
            changed |= new != known[block]
            known[block] = new
    return known


def _onward(found: Iterable[Edge]) -> dict[int, list[int]]:
    """Return where control goes from each block."""
    onward: dict[int, list[int]] = {}
    for each in found:
        onward.setdefault(each.source, []).append(each.target)
    return onward


def _reached(onward: Mapping[int, Iterable[int]], entry: int) -> set[int]:
    reached, waiting = {entry}, [entry]
    while waiting:
        for block in onward.get(waiting.pop(), ()):
            if block not in reached:
                reached.add(block)
                waiting.append(block)
    return reached


def _body(found: Sequence[Edge], back: Edge) -> set[int]:
    """Return the blocks from which control can come to the source of a back edge without passing its target."""
    body, waiting = {back.target, back.source}, [back.source]
    while waiting:
        at = waiting.pop()
        if at == back.target:
            continue
        for each in found:
            if each.target == at and each.source not in body:
                body.add(each.source)
                waiting.append(each.source)
    return body
