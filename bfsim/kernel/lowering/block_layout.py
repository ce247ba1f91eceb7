"""The order of the blocks in the code, and what their branches cost each way.

The order is that of GCC's reordering pass in outline [bb-reorder.cc; Pettis and Hansen, PLDI 1990]: from the
entry along the likeliest edges; then from the likeliest block that is left.
"""

from __future__ import annotations

from itertools import pairwise

from bfsim.kernel.ir_text import SourceLine
from bfsim.kernel.isa import Op
from bfsim.kernel.loops import ControlFlow, Loop
from bfsim.kernel.lowering.charges import Charge, charge
from bfsim.kernel.lowering.predict import EVEN, Likelihood


class BlockLayout:
    """Positions of the blocks of one routine.

    `skipped` blocks hold no code. An edge with copies of its own is a block, too: `copies` holds their cost by edge.
    """

    def __init__(
        self,
        flow: ControlFlow,
        likelihood: Likelihood,
        skipped: frozenset[str],
        copies: dict[tuple[str, str], list[Charge]],
        *,
        leaving_side_last: bool,
    ) -> None:
        self.flow, self.likelihood, self.skipped, self.copies = flow, likelihood, skipped, copies
        self.leaving_side_last = leaving_side_last
        self.names = [*self._named(copies)]
        self.order = self._order()
        self.next_of = dict(pairwise(self.order))

    def _named(self, copies: dict[tuple[str, str], list[Charge]]) -> list[str]:
        """Blocks with code, in the order of the source; an edge's copies right before where it leads."""
        names = []
        for label in self.flow.order:
            names += [edge_name(edge) for edge in copies if edge[1] == label]
            if label not in self.skipped:
                names.append(label)
        return names

    def ways(self, name: str) -> tuple[str, ...]:
        """Where a block or an edge's copies lead."""
        if name not in self.flow.blocks:
            return (self.landing(name.split(">")[1]),)
        found = []
        for way in self.flow.blocks[name].successors:
            found.append(edge_name((name, way)) if (name, way) in self.copies else self.landing(way))
        return tuple(found)

    def landing(self, label: str) -> str:
        """Where a jump to `label` ends: behind blocks that hold no code."""
        while label in self.skipped:
            ways = self.flow.blocks[label].successors
            label = self.likelihood.second_parts.get(label) or next(each for each in ways if each != label)
        return label

    def _order(self) -> list[str]:
        left = list(self.names)
        order: list[str] = []
        while left:
            name: str | None = left[0] if not order else self._likeliest(left, order)
            while name is not None:
                order.append(name)
                left.remove(name)
                name = self._onwards(name, left)
        return self._rotated(order)

    def _likeliest(self, left: list[str], order: list[str]) -> str:
        reached = {way for before in order for way in self.ways(before)}
        ready = [each for each in left if each in reached] or left
        return max(ready, key=lambda name: (self._frequency(name), -left.index(name)))

    def _frequency(self, name: str) -> float:
        if name in self.flow.blocks:
            return self.likelihood.frequency[name]
        label, way = name.split(">")
        return self.likelihood.frequency[label] * self.likelihood.taken[label, way]

    def _onwards(self, name: str, left: list[str]) -> str | None:
        """The likeliest way that is still free; of two equal ones the side that the source has first."""
        chances: dict[str, float] = {}
        targets = self.flow.blocks[name].successors if name in self.flow.blocks else (name.split(">")[1],)
        for way, target in zip(self.ways(name), targets, strict=True):
            chances[way] = chances.get(way, 0) + self.likelihood.taken.get((name, target), 1.0)
        free = [each for each in chances if each in left]
        best = max(
            free,
            key=lambda way: (chances[way], not self._may_leave(name, way, free), -left.index(way)),
            default=None,
        )
        for way in free:
            # the body of an `if` stays in line unless it is rare: half as likely as what skips it
            is_body = way != best and self.ways(way) == (best,) and self._entries(way) == 1
            if best is not None and is_body and 2 * chances[way] >= chances[best]:
                return way
        return best

    def _may_leave(self, name: str, way: str, ways: list[str]) -> bool:
        """Whether a side of a test may leave the loop before it meets the other side."""
        loop = self.flow.innermost(name) if name in self.flow.blocks else None
        if not self.leaving_side_last or loop is None or len(ways) < 2 or way == loop.latch:
            return False
        seen, waiting = {*ways, loop.header, loop.latch}, [way]
        while waiting:
            for after in self.ways(waiting.pop()):
                if after in self.flow.blocks and after not in loop.blocks:
                    return True
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
        return False

    def _entries(self, name: str) -> int:
        return len(self.flow.predecessors[name]) if name in self.flow.blocks else 1

    def _rotated(self, order: list[str]) -> list[str]:
        """Rotate each loop that would jump back so that it ends with its likeliest exit: the test moves to the bottom."""
        for loop in self.flow.loops:
            if len(set(self.flow.blocks[loop.latch].successors)) != 1:
                continue
            inside = [name for name in order if name.split(">")[0] in loop.blocks]
            first = order.index(inside[0])
            exits = [label for label in self.flow.exits(loop) if label in inside]
            if order[first : first + len(inside)] != inside or not exits:
                continue
            last = max(exits, key=lambda label: (self._leaving(label, loop), inside.index(label)))
            cut = inside.index(last) + 1
            order[first : first + len(inside)] = inside[cut:] + inside[:cut]
        return order

    def _leaving(self, label: str, loop: Loop) -> float:
        chances = (
            self.likelihood.taken[label, way] for way in set(self.flow.blocks[label].successors) - loop.blocks
        )
        return self.likelihood.frequency[label] * sum(chances)

    def falls(self, name: str, target: str) -> bool:
        """Whether `target` follows `name` in the code."""
        return self.next_of.get(name) == target

    def jump(self, name: str, target: str, line: SourceLine) -> list[Charge]:
        """Return the cost of going on to `target`."""
        return [] if self.falls(name, target) else [charge(Op.JUMP, line)]

    def on(self, label: str, target: str, line: SourceLine) -> list[Charge]:
        """Return the cost of going from the end of `label` to the block `target`, its edge's copies included."""
        edge = edge_name((label, target))
        if (label, target) not in self.copies:
            return self.jump(label, self.landing(target), line)
        return [*self.jump(label, edge, line), *self._behind(label, target, line)]

    def _behind(self, label: str, target: str, line: SourceLine) -> list[Charge]:
        if (label, target) not in self.copies:
            return []
        return [
            *self.copies[label, target],
            *self.jump(edge_name((label, target)), self.landing(target), line),
        ]

    def sides(self, label: str, line: SourceLine) -> tuple[list[Charge], list[Charge]]:
        """Return the cost of a conditional branch when its condition is true, and when it is false."""
        ways = self.ways(label)
        targets = self.flow.blocks[label].successors
        if ways[0] == ways[1]:
            return [], []
        yes_chance = self.likelihood.taken[label, targets[0]]
        if self.falls(label, ways[1]):
            through = 1
        elif self.falls(label, ways[0]):
            through = 0
        else:  # the likelier side gets the branch, the other one a jump
            through = 0 if yes_chance < EVEN else 1
        predicted = (1 - yes_chance if through == 0 else yes_chance) >= EVEN
        fall = [charge(Op.BRANCH_NOT_TAKEN_BP if predicted else Op.BRANCH_NOT_TAKEN, line)]
        fall += self.jump(label, ways[through], line) + self._behind(label, targets[through], line)
        taken = [charge(Op.BRANCH_TAKEN_BP if predicted else Op.BRANCH_TAKEN, line)]
        taken += self._behind(label, targets[1 - through], line)
        return (fall, taken) if through == 0 else (taken, fall)


def edge_name(edge: tuple[str, str]) -> str:
    """Name of the copies on an edge, as if they were a block."""
    return f"{edge[0]}>{edge[1]}"


def edge_of(name: str) -> tuple[str, str]:
    """The edge whose copies have a name."""
    label, way = name.split(">")
    return label, way
