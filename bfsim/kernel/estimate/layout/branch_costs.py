"""The costs of branches and jumps on each side, with the blocks in the order of the code (`block_order`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from bfsim.kernel.costs.charges import Charge, charge, instead
from bfsim.kernel.estimate.layout.code_blocks import CodeBlocks, edge_of
from bfsim.kernel.estimate.layout.traces import Layout
from bfsim.kernel.estimate.prediction.predict import EVEN, Likelihood
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.operations import COSTS, Op


class BranchCosts:
    """The costs in one routine. `copies`: what the copies on an edge cost, by edge."""

    def __init__(
        self,
        blocks: CodeBlocks,
        layout: Layout,
        likelihood: Likelihood,
        copies: Mapping[tuple[str, str], Sequence[Charge]],
    ) -> None:
        self.blocks, self.flow, self.likelihood, self.copies = blocks, blocks.flow, likelihood, copies
        self.copied = layout.copied
        self.next_of = dict(pairwise(layout.order))

    def falls(self, name: str, target: str) -> bool:
        """Whether `target`, or a copy of it, follows `name` in the code."""
        return self.next_of.get(name) == target or (name, target) in self.copied

    def jump(self, name: str, target: str, line: SourceLine) -> list[Charge]:
        """Return the cost of going on to `target`; for a copy, the extra cost of its end."""
        if (name, target) in self.copied:
            return self._more(target, self.next_of.get(name))
        return [] if self.falls(name, target) else [charge(Op.JUMP, line)]

    def _more(self, name: str, behind: str | None) -> list[Charge]:
        """The extra cost of the end of a copy of `name`; `behind` is what follows the copy.

        The sides of a test are not counted separately for its copies: all are charged the extra cost of the likelier
        one [assumed].
        """
        ways = self.blocks.ways(name)
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
        if label in self.blocks.tails:
            tail = self.blocks.tails[label]
            there = [] if label in self.blocks.gone else self.jump(label, self.blocks.landing(tail), line)
            return [*there, *self.on(tail, self.flow.blocks[tail].successors[0], line)]
        if (label, target) not in self.copies:
            return self.jump(label, self.blocks.end_of(label, target), line)
        copies = self.blocks.copies_on(label, target)
        return [*self.jump(label, copies, line), *self._behind(label, target, line)]

    def _behind(self, label: str, target: str, line: SourceLine) -> list[Charge]:
        """What the copies on an edge cost, and going on from them."""
        if (label, target) not in self.copies:
            return []
        return [
            *self.copies[label, target],
            *self.jump(self.blocks.copies_on(label, target), self.blocks.landing(target), line),
        ]

    def sides(self, label: str, line: SourceLine) -> tuple[list[Charge], list[Charge]]:
        """Return the cost of a conditional branch when its condition is true, and when it is false."""
        ways = self.blocks.ways(label)
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
        """The side of a branch that needs no jump; if both are elsewhere, the likelier one gets the branch, the other one a jump."""
        ways = self.blocks.ways(label)
        if self.falls(label, ways[1]):
            return 1
        if self.falls(label, ways[0]):
            return 0
        return 0 if self.likelihood.taken[label, self.flow.blocks[label].successors[0]] < EVEN else 1


def _likely_cclk(falls: bool) -> int:
    """What a branch costs on its likelier side, which needs no jump or is predicted."""
    return COSTS[Op.BRANCH_NOT_TAKEN if falls else Op.BRANCH_TAKEN_BP].cclk
