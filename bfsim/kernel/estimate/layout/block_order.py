"""The order of the blocks in the code: the input of GCC's reordering pass (`traces`)."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection

from bfsim.kernel.estimate.layout.code_blocks import CodeBlocks
from bfsim.kernel.estimate.layout.traces import Edge, Graph, Layout, laid_out
from bfsim.kernel.estimate.prediction.predict import Likelihood


def ordered(
    blocks: CodeBlocks,
    likelihood: Likelihood,
    nbytes: Callable[[str], int],
    jumps: Collection[tuple[str, str]],
) -> Layout:
    """Return the order of the blocks. `nbytes`: of a block's code; `jumps`: edges that always need a jump."""
    names = blocks.names
    count = {name: blocks.frequency(name, likelihood) for name in names}
    edges = {name: _edges(blocks, likelihood, name, count[name], jumps) for name in names}
    headers = {loop.header: loop.blocks for loop in blocks.flow.loops}
    back = frozenset(
        (name, edge.target)
        for name in names
        for edge in edges[name]
        if name.split(">")[0] in headers.get(edge.target, ())
    )
    ends = frozenset(name for name in names if not edges[name])
    sizes = {each: nbytes(each) for each in names}
    following = {name: min(ways, key=_place(blocks, name)) for name in names if (ways := blocks.ways(name))}
    return laid_out(Graph(names, edges, count, sizes, following, back, ends))


def _edges(
    blocks: CodeBlocks, likelihood: Likelihood, name: str, count: float, jumps: Collection[tuple[str, str]]
) -> tuple[Edge, ...]:
    """The edges from block `name`, which runs `count` times: one to each target, even if several sides of its test go there."""
    chances: dict[str, float] = {}
    never_fall = set[str]()
    for way, target in zip(blocks.ways(name), blocks.targets(name), strict=True):
        chances[way] = chances.get(way, 0) + likelihood.taken.get((name, target), 1.0)
        if (name, target) in jumps:
            never_fall.add(way)
    return tuple(
        Edge(name, way, chance, count * chance, way not in never_fall) for way, chance in chances.items()
    )


def _place(blocks: CodeBlocks, name: str) -> Callable[[str], tuple[float, int]]:
    """Where a side of the test at the end of block `name` stands in the source, after it."""
    flow = blocks.flow
    test = flow.blocks[name].terminator.line if name in flow.blocks else None

    def place(way: str) -> tuple[float, int]:
        rows = flow.blocks[way].instructions if way in flow.blocks else ()
        line = next((each.line for each in rows if each.opcode != "phi"), None)
        known = line is not None and test is not None and line._replace(line=0) == test._replace(line=0)
        behind = known and line is not None and test is not None and line.line > test.line
        return line.line if behind and line else math.inf, blocks.names.index(way)

    return place
