"""An iteration of a loop: the cheapest and the dearest path through it, and what bounds it."""

from __future__ import annotations

from collections import Counter as Tally
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from bfsim.blackfin.control_flow.blocks import BRANCHES, CALLS, COMPUTED, DIRECT, Code, does
from bfsim.blackfin.control_flow.flow import Edge, Loop, Way, dominators
from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.dependences import registers_of
from bfsim.blackfin.timing.interlocks import NOTHING, holds, issued_in_turn, made_by
from bfsim.blackfin.timing.stalls import fetched_anew
from bfsim.blackfin.timing.tables import Timing

CONTROL = DIRECT | COMPUTED | CALLS | BRANCHES


@dataclass(frozen=True, slots=True)
class Chain:
    """Registers each of which is computed from the one before, the first from the last: at least `cclk` an iteration."""

    cclk: Fraction
    registers: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Turn:
    """An iteration on one path, inner loops once: cycles of instructions, of jumps beyond the first of each, of waits."""

    instructions: tuple[Instruction, ...]
    issue_cclk: int
    jump_cclk: int
    stall_cclk: int

    @property
    def cclk(self) -> int:
        """All cycles of the iteration, without callees."""
        return self.issue_cclk + self.jump_cclk + self.stall_cclk


def turns(code: Code, loop: Loop, found: Sequence[Edge], timing: Timing) -> tuple[Turn, Turn]:
    """Return the cheapest and the dearest iteration of a loop; waits are counted on these two paths, but choose neither."""
    inside = [each for each in found if each.source in loop.blocks and each.target in loop.blocks]
    before = dominators(inside, loop.head)
    onward = [each for each in inside if each.target not in before.get(each.source, ())]
    ends = [each for each in inside if each.target == loop.head]
    cheapest, dearest = (
        _turn(code, _way(code, loop.head, onward, ends, timing, sign), timing) for sign in (1, -1)
    )
    return (cheapest, dearest) if cheapest.cclk <= dearest.cclk else (dearest, cheapest)


def _way(
    code: Code, head: int, onward: Sequence[Edge], ends: Sequence[Edge], timing: Timing, sign: int
) -> list[Edge]:
    """Return the cheapest (with `sign` -1, the dearest) path through a loop to its head; `onward`: edges without cycles."""
    cclk = {head: 0}
    by: dict[int, Edge] = {}
    waiting = Tally(each.target for each in onward)
    done: set[int] = set()
    while open_ := cclk.keys() - done:
        at = min(open_, key=lambda each: (waiting[each], each))  # 0, unless loops have two entries
        done.add(at)
        for each in (each for each in onward if each.source == at and each.target not in done):
            found = cclk[at] + _cclk(code, each, timing)
            if each.target not in cclk or sign * found < sign * cclk[each.target]:
                cclk[each.target], by[each.target] = found, each
            waiting[each.target] -= 1
    known = [each for each in ends if each.source in cclk]
    way = [min(known, key=lambda each: sign * (cclk[each.source] + _cclk(code, each, timing)))]
    while way[-1].source != head:
        way.append(by[way[-1].source])
    return way[::-1]


def _cclk(code: Code, edge: Edge, timing: Timing) -> int:
    """Return the cycles of a block that is left by an edge."""
    block = code.blocks[edge.source]
    cclk = sum(map(timing.of, block.instructions))
    if block.branches and edge.way is Way.JUMPS:
        cclk += timing.taken(block.instructions[-1]) - timing.of(block.instructions[-1])
    return cclk


def _turn(code: Code, way: Sequence[Edge], timing: Timing) -> Turn:
    """Return the iteration along edges. Its waits are those after another iteration on the same path."""
    instructions = tuple(one for each in way for one in code.blocks[each.source].instructions)
    control = sum(does(each) in CONTROL for each in instructions)
    plain = sum(timing.of(each) for each in instructions if does(each) not in CONTROL)
    left, stall = NOTHING, 0
    for _ in range(2):
        stall = 0
        for each in way:
            block = code.blocks[each.source]
            waits, left = issued_in_turn(block.instructions, left, timing.interlocks)
            stall += sum(one.cclk for one in waits)
            left = left.later(fetched_anew(block, each.way, timing))
    jumps = sum(_cclk(code, each, timing) for each in way) - plain - control
    return Turn(instructions, plain + control, jumps, stall)


def longest_chain(turn: Turn, timing: Timing) -> Chain:
    """Return the chain of registers, from iteration to iteration, that takes longest.

    The loop cannot be faster, however much is issued at once. Dependences through memory are not seen.
    """
    last = {name: each for each in turn.instructions for name in registers_of(each).writes}
    carried = sorted(last)
    rows = {name: dict(_arrivals(name, last[name], turn.instructions, timing)) for name in carried}
    weights = {
        name: {other: cclk for other, cclk in row.items() if other in last} for name, row in rows.items()
    }
    return _heaviest_cycle(weights)


def _arrivals(
    register: str, writer: Instruction, instructions: Sequence[Instruction], timing: Timing
) -> Iterator[tuple[str, int]]:
    """Yield what depends on a register's value at the start of an iteration, and after how many cycles it is ready."""
    there: dict[str, tuple[int, Instruction]] = {register: (0, writer)}
    for each in instructions:
        found = registers_of(each)
        starts = [
            there[name][0] + _wait(there[name][1], name, each, timing) for name in found.reads & there.keys()
        ]
        for name in found.writes:
            there.pop(name, None)
            if starts:
                there[name] = (max(starts) + (1 if does(each) in CONTROL else timing.of(each)), each)
    for name, (cclk, _) in there.items():
        if cclk:
            yield name, cclk


def _wait(writer: Instruction, register: str, reader: Instruction, timing: Timing) -> int:
    first, second = registers_of(writer), registers_of(reader)
    waits = (
        each.cclk for each in timing.interlocks if register in made_by(each, first) and holds(each, second)
    )
    return max(waits, default=0)


def _heaviest_cycle(weights: Mapping[str, Mapping[str, int]]) -> Chain:
    """Return the cycle of the greatest mean weight (R. M. Karp, 1978), an empty one if there is no cycle."""
    names = sorted(weights)
    walks: list[dict[str, int]] = [dict.fromkeys(names, 0)]
    before: list[dict[str, str]] = [{}]
    for _ in names:
        reached: dict[str, int] = {}
        by: dict[str, str] = {}
        for name, cclk in walks[-1].items():
            for other, more in weights[name].items():
                if cclk + more > reached.get(other, -1):
                    reached[other], by[other] = cclk + more, name
        walks.append(reached)
        before.append(by)
    best = Chain(Fraction(0), ())
    for end in walks[-1]:
        at, walk = end, [end]
        for step in reversed(before[1:]):
            at = step[at]
            walk.append(at)
        best = max(best, *_cycles(walk[::-1], weights), key=lambda each: each.cclk)
    return best


def _cycles(walk: Sequence[str], weights: Mapping[str, Mapping[str, int]]) -> Iterator[Chain]:
    """Yield the simple cycles in a walk."""
    path: list[str] = []
    for name in walk:
        if name in path:
            cycle = path[path.index(name) :]
            total = sum(weights[one][other] for one, other in zip(cycle, [*cycle[1:], name], strict=True))
            yield Chain(Fraction(total, len(cycle)), tuple(cycle))
            path = path[: path.index(name)]
        path.append(name)
