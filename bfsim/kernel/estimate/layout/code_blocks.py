"""Blocks of a routine that hold code, and where each leads once the empty ones are gone.

The copies of values on an edge are a block, too, with its own name.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from bfsim.kernel.estimate.layout.cross_jumps import CrossJumps
from bfsim.kernel.estimate.prediction.predict import Likelihood
from bfsim.kernel.ir.control_flow import ControlFlow


class CodeBlocks:
    """Those of one routine.

    `names`: in the order of the source, the copies on an edge right before its target.
    """

    def __init__(
        self,
        flow: ControlFlow,
        landing: Landing,
        edges: Collection[tuple[str, str]],
        crossed: CrossJumps,
        threaded: Mapping[tuple[str, str], str],
    ) -> None:
        """`edges`: those with copies. `crossed`: edges and blocks that are one. `threaded`: where edges lead whose jumps are threaded."""
        self.flow, self.edges, self.threaded = flow, edges, threaded
        self.alike, self.tails, self.gone = crossed.alike, crossed.tails, crossed.gone
        self._landing = landing
        self.names = [*self._named()]

    def _named(self) -> list[str]:
        names = []
        for label in self.flow.order:
            names += [edge_name(edge) for edge in self.edges if edge[1] == label and self.alike[edge] == edge]
            if label not in self._landing.skipped and label not in self.gone:
                names.append(label)
        return names

    def ways(self, name: str) -> tuple[str, ...]:
        """The targets of a block or of an edge's copies."""
        if name not in self.flow.blocks:
            return (self.landing(edge_of(name)[1]),)
        if name in self.tails:
            return (self.landing(self.tails[name]),)
        return tuple(
            self.copies_on(name, way) if (name, way) in self.edges else self.end_of(name, way)
            for way in self.flow.blocks[name].successors
        )

    def end_of(self, label: str, way: str) -> str:
        """Where an edge without copies leads."""
        return self.landing(self.threaded.get((label, way), way))

    def targets(self, name: str) -> tuple[str, ...]:
        """The same targets as in the control flow, in the same order."""
        return self.flow.blocks[name].successors if name in self.flow.blocks else (edge_of(name)[1],)

    def landing(self, label: str) -> str:
        """Where a jump to `label` ends: after blocks that hold no code."""
        label = self._landing(label)
        return self.landing(self.tails[label]) if label in self.gone else label

    def copies_on(self, label: str, way: str) -> str:
        """Name of the copies on an edge."""
        return edge_name(self.alike[label, way])

    def frequency(self, name: str, likelihood: Likelihood) -> float:
        """How often a block or the copies of edges run, in executions per call, as guessed."""
        if name in self.flow.blocks:
            heads = (each for each, tail in self.tails.items() if tail == name)
            return likelihood.frequency[name] + sum(self.frequency(each, likelihood) for each in heads)
        edges = (edge for edge in self.edges if self.alike[edge] == edge_of(name))
        return sum(likelihood.frequency[edge[0]] * likelihood.taken[edge] for edge in edges)


class Landing:
    """Where a jump to a block ends: after `skipped` blocks, which hold no code."""

    def __init__(self, flow: ControlFlow, skipped: frozenset[str], second_parts: Mapping[str, str]) -> None:
        """`second_parts`: blocks whose test the previous block makes, and where they lead then."""
        self.flow, self.skipped, self.second_parts = flow, skipped, second_parts

    def __call__(self, label: str) -> str:
        """Return the block that a jump to `label` ends at."""
        while label in self.skipped:
            ways = self.flow.blocks[label].successors
            label = self.second_parts.get(label) or next(each for each in ways if each != label)
        return label


def edge_name(edge: tuple[str, str]) -> str:
    """Name of the copies on an edge, as if they were a block."""
    return f"{edge[0]}>{edge[1]}"


def edge_of(name: str) -> tuple[str, str]:
    """The edge whose copies have a name."""
    label, way = name.split(">")
    return label, way
