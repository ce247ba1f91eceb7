"""The order of the blocks in the code, and what their branches cost each way.

The order is that of GCC's reordering pass (`traces`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

from bfsim.kernel.ir_text import SourceLine
from bfsim.kernel.isa import COSTS, Op
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.charges import Charge, charge, instead
from bfsim.kernel.lowering.cross_jumps import CrossJumps
from bfsim.kernel.lowering.predict import EVEN, Likelihood
from bfsim.kernel.lowering.traces import Edge, Graph, Layout, laid_out


class BlockLayout:
    """Positions of the blocks of one routine.

    `skipped` blocks hold no code. An edge with copies of its own is a block, too: `copies` holds their cost by edge. `crossed`: edges and
    blocks that are one. `nbytes`: of the code of a block or an edge.
    `counted`: the ways back of counted loops, which are jumps.
    `threaded`: where edges lead whose jumps are threaded.
    """

    def __init__(
        self,
        flow: ControlFlow,
        likelihood: Likelihood,
        skipped: frozenset[str],
        copies: dict[tuple[str, str], list[Charge]],
        crossed: CrossJumps,
        nbytes: Callable[[str], int],
        counted: frozenset[tuple[str, str]],
        threaded: Mapping[tuple[str, str], str],
    ) -> None:
        self.flow, self.likelihood, self.skipped, self.copies = flow, likelihood, skipped, copies
        self.alike, self.tails, self.gone, self.threaded = (
            crossed.alike,
            crossed.tails,
            crossed.gone,
            threaded,
        )
        self.names = [*self._named(copies)]
        layout = self._laid_out(nbytes, counted)
        self.order, self.copied = layout.order, layout.copied
        self.next_of = dict(pairwise(self.order))

    def _named(self, copies: dict[tuple[str, str], list[Charge]]) -> list[str]:
        """Blocks with code, in the order of the source; an edge's copies right before where it leads."""
        names = []
        for label in self.flow.order:
            names += [edge_name(edge) for edge in copies if edge[1] == label and self.alike[edge] == edge]
            if label not in self.skipped and label not in self.gone:
                names.append(label)
        return names

    def ways(self, name: str) -> tuple[str, ...]:
        """Where a block or an edge's copies lead."""
        if name not in self.flow.blocks:
            return (self.landing(name.split(">")[1]),)
        if name in self.tails:
            return (self.landing(self.tails[name]),)
        found = []
        for way in self.flow.blocks[name].successors:
            own = (name, way) in self.copies
            found.append(
                self._copied(name, way) if own else self.landing(self.threaded.get((name, way), way))
            )
        return tuple(found)

    def landing(self, label: str) -> str:
        """Where a jump to `label` ends: behind blocks that hold no code."""
        label = landing(self.flow, self.skipped, self.likelihood.second_parts, label)
        return self.landing(self.tails[label]) if label in self.gone else label

    def _laid_out(self, nbytes: Callable[[str], int], counted: frozenset[tuple[str, str]]) -> Layout:
        count = {name: self._frequency(name) for name in self.names}
        edges = {}
        for name in self.names:
            chances: dict[str, float] = {}
            targets = self.flow.blocks[name].successors if name in self.flow.blocks else (edge_of(name)[1],)
            for way, target in zip(self.ways(name), targets, strict=True):
                chances[way] = chances.get(way, 0) + self.likelihood.taken.get((name, target), 1.0)
            jumps = {
                way for way, target in zip(self.ways(name), targets, strict=True) if (name, target) in counted
            }
            edges[name] = tuple(
                Edge(name, way, chance, count[name] * chance, way not in jumps)
                for way, chance in chances.items()
            )
        headers = {loop.header: loop.blocks for loop in self.flow.loops}
        back = frozenset(
            (name, edge.target)
            for name in self.names
            for edge in edges[name]
            if name.split(">")[0] in headers.get(edge.target, ())
        )
        ends = frozenset(name for name in self.names if not edges[name])
        sizes = {each: nbytes(each) for each in self.names}
        following = {
            name: min(ways, key=self._place(name)) for name in self.names if (ways := self.ways(name))
        }
        return laid_out(Graph(self.names, edges, count, sizes, following, back, ends))

    def _place(self, name: str) -> Callable[[str], tuple[float, int]]:
        """Where a side of the test at the end of block `name` stands in the source, behind it."""
        test = self.flow.blocks[name].terminator.line if name in self.flow.blocks else None

        def place(way: str) -> tuple[float, int]:
            rows = self.flow.blocks[way].instructions if way in self.flow.blocks else ()
            line = next((each.line for each in rows if each.opcode != "phi"), None)
            known = line is not None and test is not None and line._replace(line=0) == test._replace(line=0)
            behind = known and line is not None and test is not None and line.line > test.line
            return line.line if behind and line else math.inf, self.names.index(way)

        return place

    def _frequency(self, name: str) -> float:
        if name in self.flow.blocks:
            heads = (each for each, tail in self.tails.items() if tail == name)
            return self.likelihood.frequency[name] + sum(map(self._frequency, heads))
        edges = (edge for edge in self.copies if self.alike[edge] == edge_of(name))
        return sum(self.likelihood.frequency[edge[0]] * self.likelihood.taken[edge] for edge in edges)

    def _copied(self, label: str, way: str) -> str:
        """Name of the copies on an edge."""
        return edge_name(self.alike[label, way])

    def falls(self, name: str, target: str) -> bool:
        """Whether `target`, or a copy of it, follows `name` in the code."""
        return self.next_of.get(name) == target or (name, target) in self.copied

    def jump(self, name: str, target: str, line: SourceLine) -> list[Charge]:
        """Return the cost of going on to `target`; of a copy, what its end costs more."""
        if (name, target) in self.copied:
            return self._more(target, self.next_of.get(name))
        return [] if self.falls(name, target) else [charge(Op.JUMP, line)]

    def _more(self, name: str, behind: str | None) -> list[Charge]:
        """What the end of a copy of `name` costs more than its own; `behind` is what follows the copy.

        The sides of a test are not counted apart for its copies: all of them are charged what the likelier one costs more [assumed].
        """
        ways = self.ways(name)
        line = self.flow.blocks[name if name in self.flow.blocks else edge_of(name)[0]].terminator.line
        if len(set(ways)) == 1:
            own = [] if behind == ways[0] else [charge(Op.JUMP, line)]
            return [*instead(own, self.jump(name, ways[0], line))]
        if name not in self.flow.blocks or len(ways) != 2:
            return []
        targets = self.flow.blocks[name].successors
        likely = 0 if self.likelihood.taken[name, targets[0]] >= EVEN else 1
        more = _likely_cclk(behind == ways[likely]) - _likely_cclk(self._through(name) == likely)
        return [Charge(Op.COPIED_BRANCH, line, more)] if more else []

    def on(self, label: str, target: str, line: SourceLine) -> list[Charge]:
        """Return the cost of going from the end of `label` to the block `target`, its edge's copies included."""
        if label in self.tails:
            tail = self.tails[label]
            there = [] if label in self.gone else self.jump(label, self.landing(tail), line)
            return [*there, *self.on(tail, self.flow.blocks[tail].successors[0], line)]
        if (label, target) not in self.copies:
            return self.jump(label, self.landing(self.threaded.get((label, target), target)), line)
        return [*self.jump(label, self._copied(label, target), line), *self._behind(label, target, line)]

    def _behind(self, label: str, target: str, line: SourceLine) -> list[Charge]:
        if (label, target) not in self.copies:
            return []
        return [
            *self.copies[label, target],
            *self.jump(self._copied(label, target), self.landing(target), line),
        ]

    def sides(self, label: str, line: SourceLine) -> tuple[list[Charge], list[Charge]]:
        """Return the cost of a conditional branch when its condition is true, and when it is false."""
        ways = self.ways(label)
        targets = self.flow.blocks[label].successors
        if ways[0] == ways[1]:
            return [], []
        yes_chance, through = self.likelihood.taken[label, targets[0]], self._through(label)
        predicted = (1 - yes_chance if through == 0 else yes_chance) >= EVEN
        fall = [charge(Op.BRANCH_NOT_TAKEN_BP if predicted else Op.BRANCH_NOT_TAKEN, line)]
        fall += self.jump(label, ways[through], line) + self._behind(label, targets[through], line)
        taken = [charge(Op.BRANCH_TAKEN_BP if predicted else Op.BRANCH_TAKEN, line)]
        taken += self._behind(label, targets[1 - through], line)
        return (fall, taken) if through == 0 else (taken, fall)

    def _through(self, label: str) -> int:
        """Which side of a branch needs no jump; the likelier one gets the branch if both are elsewhere, the other one a jump."""
        ways = self.ways(label)
        if self.falls(label, ways[1]):
            return 1
        if self.falls(label, ways[0]):
            return 0
        return 0 if self.likelihood.taken[label, self.flow.blocks[label].successors[0]] < EVEN else 1


def landing(flow: ControlFlow, skipped: frozenset[str], second_parts: Mapping[str, str], label: str) -> str:
    """Return where a jump to `label` ends, behind `skipped` blocks."""
    while label in skipped:
        ways = flow.blocks[label].successors
        label = second_parts.get(label) or next(each for each in ways if each != label)
    return label


def _likely_cclk(falls: bool) -> int:
    """What a branch costs on its likelier side, which needs no jump or is predicted."""
    return COSTS[Op.BRANCH_NOT_TAKEN if falls else Op.BRANCH_TAKEN_BP].cclk


def edge_name(edge: tuple[str, str]) -> str:
    """Name of the copies on an edge, as if they were a block."""
    return f"{edge[0]}>{edge[1]}"


def edge_of(name: str) -> tuple[str, str]:
    """The edge whose copies have a name."""
    label, way = name.split(">")
    return label, way
