"""Paths past a test whose answer is known on them: what they copy, and how a loop is entered then [tree-ssa-threadbackward.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import llvmlite.binding as llvm

from bfsim.kernel.estimate.switches.copied_ways import copied_block
from bfsim.kernel.ir import llvm_passes
from bfsim.kernel.ir.control_flow import BACK, ControlFlow
from bfsim.kernel.ir.edges import bypass, going_to, put_between
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine
from bfsim.kernel.ir.writing import with_names, write_module

BEFORE = ".before"
"""Ends the label of a block without code in which several entries of a loop join."""

COPY = ".kept"
"""Ends, before a number, the label of a copied block."""


@dataclass(frozen=True, slots=True)
class KnownWays:
    """Paths to a test at the end of a `chain` of blocks; from each of the blocks `before`, control surely goes on to block `goal`."""

    chain: tuple[str, ...]
    goal: str
    before: tuple[str, ...]
    goes_back: bool
    """Whether the goal begins the loop, which must then have a single way back."""
    begins: int | None = None
    """The successor to which the chain's last block leads from all other blocks, if known."""

    @property
    def ways(self) -> Iterator[tuple[str, str, dict[str, str]]]:
        """Each such block, with the names of a block between it and the chain, and of copies of the blocks of that."""
        for number, each in enumerate(self.before):
            copied = (*self.chain, self.onward)
            yield each, f"{self.chain[0]}.way{number}", {block: f"{block}{COPY}{number}" for block in copied}

    @property
    def onward(self) -> str:
        """The name of a block between the chain and its goal, which sets the goal's variables."""
        return f"{self.chain[-1]}.onward"


def with_known_ways(
    text: str,
    each_known: Callable[[ControlFlow], Iterator[KnownWays]],
    prepared: Callable[[Routine, list[KnownWays]], Routine] = lambda routine, _: routine,
    tidied: Callable[[Routine], Routine] = lambda routine: routine,
) -> str:
    """Return the module `text` with the paths that `each_known` yields for each routine led past their tests.

    `prepared` prepares a routine for this; `tidied` gets the result while its variables are in memory.
    """
    named = with_names(text)
    routines = read_module(named)
    kept = {each.symbol: [*each_known(ControlFlow(each))] for each in routines}
    if not any(kept.values()):
        return text
    parted = [_with_ways(prepared(each, kept[each.symbol]), kept[each.symbol]) for each in routines]
    module = llvm.parse_assembly(write_module(named, parted))
    llvm_passes.run(("register_to_memory",), module)
    named = with_names(str(module))
    threaded = [tidied(_threaded(each, kept[each.symbol])) for each in read_module(named)]
    module = llvm.parse_assembly(write_module(named, threaded))
    llvm_passes.run(("sroa", "sccp", "aggressive_dce"), module)
    named = with_names(str(module))
    cleaned = [
        _with_copies_joined(_without_empty_blocks(each, before.blocks))
        for each, before in zip(read_module(named), routines, strict=True)
    ]
    return write_module(named, cleaned)


def with_one_way(routine: Routine) -> Routine:
    """Return `routine`, whose variables are in memory, with one block that enters each loop, and one that leads back to its start."""
    blocks = {each.label: each for each in routine.blocks}
    flow = ControlFlow(routine)
    for loop in flow.loops:
        before = flow.predecessors[loop.header]
        back = [each for each in before if each in loop.blocks]
        for ways, ending in ((back, BACK), ([each for each in before if each not in back], BEFORE)):
            label = loop.header + ending
            for each in ways if len(ways) > 1 else ():
                blocks[each] = going_to(blocks[each], loop.header, label)
                blocks[label] = BasicBlock(label, (_jump(loop.header, blocks[each].terminator),))
    return replace(routine, blocks=tuple(blocks.values()))


def _leading_to(block: BasicBlock, goal: str) -> BasicBlock:
    """Return a block that leads to `goal`, and makes no test."""
    *rows, end = block.instructions
    return replace(block, instructions=(*rows, _jump(goal, end)))


def _jump(goal: str, at: Instruction) -> Instruction:
    return Instruction(None, "br", f"br label %{goal}", (), at.line, location=at.location)


def _with_ways(routine: Routine, kept: list[KnownWays]) -> Routine:
    """Return `routine` with a separate block on each path, which sets its variables."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for before, way, _ in each.ways:
            put_between(blocks, before, each.chain[0], way)
        put_between(blocks, each.chain[-1], each.goal, each.onward)
        if each.goes_back:
            put_between(blocks, each.onward, each.goal, each.chain[-1] + BACK)
    return replace(routine, blocks=tuple(blocks.values()))


def _threaded(routine: Routine, kept: list[KnownWays]) -> Routine:
    """Return `routine`, whose variables are in memory, with a copy of a chain for each path that needs one test less."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for _, way, copies in each.ways:
            blocks[way] = going_to(blocks[way], each.chain[0], copies[each.chain[0]])
            for label, copy in copies.items():
                made = copied_block(blocks[label], copy, each.onward if label == each.chain[-1] else "")
                for successor in made.successors:
                    made = going_to(made, successor, copies.get(successor, successor))
                blocks[copy] = made
        if each.begins is not None:
            last = blocks[each.chain[-1]]
            blocks[last.label] = _leading_to(last, last.successors[each.begins])
            if not any(each.onward in block.successors for block in blocks.values()):
                del blocks[each.onward]
    return replace(routine, blocks=tuple(blocks.values()))


def _without_empty_blocks(routine: Routine, kept: Iterable[BasicBlock]) -> Routine:
    """Return `routine` without empty blocks, except those `kept` and those that a phi tells from another path."""
    blocks = {each.label: each for each in routine.blocks}
    stays = {each.label for each in kept}
    for label in [*blocks]:
        block = blocks[label]  # if a block after it is gone, it leads elsewhere now
        before = [each.label for each in blocks.values() if label in each.successors]
        goals = block.successors
        is_empty = len(block.instructions) == len(goals) == 1 and not block.enters
        if (
            is_empty
            and label not in stays
            and not label.endswith(BEFORE)
            and not any({*goals} & {*blocks[each].successors} for each in before)
        ):
            bypass(blocks, before, label, goals[0])
    return replace(routine, blocks=tuple(blocks.values()))


def _with_copies_joined(routine: Routine) -> Routine:
    """Return `routine` with each copy and the block to which it alone leads as one block."""
    blocks = {each.label: each for each in routine.blocks}
    for label in [each for each in blocks if COPY in each]:
        (goal, *others) = blocks[label].successors or ("",)
        before = [each.label for each in blocks.values() if label in each.successors]
        behind = blocks.get(goal)
        is_alone = [each.label for each in blocks.values() if goal in each.successors] == [label]
        phis = [
            each
            for block in (blocks[label], behind)
            if block
            for each in block.instructions
            if each.opcode == "phi"
        ]
        if others or behind is None or not is_alone or phis or goal == label:
            continue
        rows = (*blocks[label].instructions[:-1], *behind.instructions)
        blocks[goal] = replace(behind, instructions=rows, enters=(*blocks[label].enters, *behind.enters))
        for each in before:
            blocks[each] = going_to(blocks[each], label, goal)
        del blocks[label]
    return replace(routine, blocks=tuple(blocks.values()))
