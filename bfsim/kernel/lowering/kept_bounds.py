"""Where an iteration leaves a number as it was, its bound is not tested again [tree-ssa-threadbackward.cc of GCC 12].

Of `while i < n and k < 100`, an iteration that counts no `k` ends with the test of `i` alone: `k < 100` was so before it. The same is
true where it sets `k` to a number that is below 100. GCC copies the end of the loop for each such way to it. Of a number that must stay below another
variable nothing is known: the ranges that GCC has are of numbers.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import llvmlite.binding as llvm

from bfsim.kernel import generic
from bfsim.kernel.ir_reading import read_module
from bfsim.kernel.ir_text import BasicBlock, Routine
from bfsim.kernel.ir_writing import with_names, write_module
from bfsim.kernel.loops import BACK, ControlFlow
from bfsim.kernel.lowering.copied_ways import copied_block
from bfsim.kernel.lowering.edges import bypass, going_to, put_between
from bfsim.kernel.lowering.kept_tests import KeptTest, each_kept


def with_kept_bounds(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with such ends copied."""
    named = with_names(text)
    routines = read_module(named)
    kept = {each.symbol: [*each_kept(ControlFlow(each))] for each in routines}
    if not any(kept.values()):
        return text
    parted = [_with_ways(each, kept[each.symbol]) for each in routines]
    module = llvm.parse_assembly(write_module(named, parted))
    generic.run(("register_to_memory",), module)
    named = with_names(str(module))
    threaded = [_threaded(each, kept[each.symbol]) for each in read_module(named)]
    module = llvm.parse_assembly(write_module(named, threaded))
    generic.run(("sroa", "aggressive_dce"), module)
    named = with_names(str(module))
    cleaned = [
        _without_empty_blocks(each, before.blocks)
        for each, before in zip(read_module(named), routines, strict=True)
    ]
    return write_module(named, cleaned)


def _with_ways(routine: Routine, kept: list[KeptTest]) -> Routine:
    """Return `routine` with a block of its own on each way, on which its variables are set."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for before, way, _ in each.ways:
            put_between(blocks, before, each.chain[0], way)
        put_between(blocks, each.chain[-1], each.goal, each.onward)
        if each.goes_back:
            put_between(blocks, each.onward, each.goal, each.chain[-1] + BACK)
    return replace(routine, blocks=tuple(blocks.values()))


def _threaded(routine: Routine, kept: list[KeptTest]) -> Routine:
    """Return `routine`, whose variables are in memory, with a copy of a chain for each way that needs one test less."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for _, way, copies in each.ways:
            blocks[way] = going_to(blocks[way], each.chain[0], copies[each.chain[0]])
            for label, copy in copies.items():
                made = copied_block(blocks[label], copy, each.onward if label == each.chain[-1] else "")
                for successor in made.successors:
                    made = going_to(made, successor, copies.get(successor, successor))
                blocks[copy] = made
    return replace(routine, blocks=tuple(blocks.values()))


def _without_empty_blocks(routine: Routine, kept: Iterable[BasicBlock]) -> Routine:
    """Return `routine` without empty blocks, but those that are `kept`, where no phi tells them from another way."""
    blocks = {each.label: each for each in routine.blocks}
    stays = {each.label for each in kept}
    for block in routine.blocks:
        before = [each.label for each in blocks.values() if block.label in each.successors]
        goals = block.successors
        is_empty = len(block.instructions) == len(goals) == 1 and not block.enters
        if (
            is_empty
            and block.label not in stays
            and not any({*goals} & {*blocks[each].successors} for each in before)
        ):
            bypass(blocks, before, block.label, goals[0])
    return replace(routine, blocks=tuple(blocks.values()))
