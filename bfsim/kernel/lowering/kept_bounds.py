"""Where an iteration leaves a number as it was, its bound is not tested again [tree-ssa-threadbackward.cc of GCC 12].

Of `while i < n and k < 100`, an iteration that counts no `k` ends with the test of `i` alone: `k < 100` was so before it. The same is
true where it sets `k` to a number that is below 100. GCC copies the end of the loop for each such way to it. Of a number that must stay below another
variable nothing is known: the ranges that GCC has are of numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import llvmlite.binding as llvm

from bfsim.kernel import generic
from bfsim.kernel.ir_reading import read_module
from bfsim.kernel.ir_text import BasicBlock, Instruction, Routine, arms_of, is_number, predicate, renamed
from bfsim.kernel.ir_writing import with_names, write_module
from bfsim.kernel.loops import BACK, ControlFlow, Loop
from bfsim.kernel.lowering.copied_ways import answered
from bfsim.kernel.lowering.edges import bypass, going_to, put_between
from bfsim.kernel.lowering.threaded_choices import MOST_ON_A_WAY
from bfsim.kernel.lowering.value_ranges import answer

CONDITION = 2
"""What a condition and its branch count of that [estimate_num_insns in tree-inline.cc]."""


@dataclass(frozen=True, slots=True)
class _Kept:
    """A test at the end of a `chain` of blocks, the way through which goes on to block `goal` for sure from each of the blocks `before`."""

    chain: tuple[str, ...]
    goal: str
    before: tuple[str, ...]
    goes_back: bool
    """Whether the goal begins the loop, which must be come back to from one block."""

    @property
    def ways(self) -> Iterator[tuple[str, str, dict[str, str]]]:
        """Each such block, with the names of a block between it and the chain, and of copies of the blocks of that."""
        for number, each in enumerate(self.before):
            copied = (*self.chain, self.onward)
            yield each, f"{self.chain[0]}.way{number}", {block: f"{block}.kept{number}" for block in copied}

    @property
    def onward(self) -> str:
        """The name of a block between the chain and its goal, on which variables of that are set."""
        return f"{self.chain[-1]}.onward"


def with_kept_bounds(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with such ends copied."""
    named = with_names(text)
    routines = read_module(named)
    kept = {each.symbol: [*_each_kept(ControlFlow(each))] for each in routines}
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


def _each_kept(flow: ControlFlow) -> Iterator[_Kept]:
    """Such tests, of which none is on a way to the chain of another."""
    seen, ends = set[str](), set[str]()
    for loop in flow.loops:
        for label in flow.inside(loop):
            kept = _kept(flow, loop, label) if label != loop.header and label not in seen else None
            if kept is not None and ends.isdisjoint(kept.before):
                ends.add(kept.chain[-1])
                yield kept
            seen.add(label)


def _kept(flow: ControlFlow, loop: Loop, label: str) -> _Kept | None:
    """The test that some ways to a block of `loop` answer, behind it or a few others that only leave the loop."""
    before = flow.predecessors[label]
    cost = 0
    for chain, goal in _chains(flow, loop, label):
        cost += _cost(flow.blocks[chain[-1]])
        if cost - CONDITION > MOST_ON_A_WAY or len(before) < 2:
            return None
        end = flow.blocks[chain[-1]].terminator
        test = flow.instruction(end.operands[0])
        if test is None or test.opcode != "icmp":
            continue
        goes_on = flow.blocks[chain[-1]].successors[0] == goal
        known = tuple(each for each in before if _answer(flow, loop, label, test, each) is goes_on)
        if known:
            return _Kept(chain, goal, known, goal == loop.header)
    return None


def _chains(flow: ControlFlow, loop: Loop, label: str) -> Iterator[tuple[tuple[str, ...], str]]:
    """Blocks from one on that each leave `loop` or go on to the next, and where the last one goes on to."""
    chain: tuple[str, ...] = ()
    while True:
        block = flow.blocks[label]
        inside = [each for each in block.successors if each in loop.blocks]
        if block.terminator.opcode != "br" or len(set(block.successors)) < 2 or len(inside) != 1:
            return
        chain = (*chain, label)
        (label,) = inside
        yield chain, label
        if flow.predecessors[label] != [chain[-1]]:
            return


def _cost(block: BasicBlock) -> int:
    """What a copy of a block counts."""
    rows = [each for each in block.instructions if each.opcode not in ("phi", "icmp", "br")]
    return len(rows) + CONDITION


def _answer(flow: ControlFlow, loop: Loop, label: str, test: Instruction, way: str) -> bool | None:
    """What a `test` of a number that is merged in block `label` says where that is come to from block `way`."""
    merged = test.operands[0]
    phi = flow.instruction(merged)
    if phi is None or phi.opcode != "phi" or flow.defined[merged][0] != label:
        return None
    value = arms_of(phi)[way]
    before = flow.instruction(value)
    if before is None or before.opcode != "phi" or flow.defined[value][0] != loop.header:
        return _said(flow, loop, test, value)
    arms = arms_of(before)
    if arms.pop(loop.latch) != merged or not is_number(test.operands[1]):
        return None
    first, *others = {_said(flow, loop, test, each) for each in arms.values()}
    return None if others else first


def _said(flow: ControlFlow, loop: Loop, test: Instruction, value: str) -> bool | None:
    """What a test says of a number, by what is known of its bound where the loop begins."""
    if not is_number(value):
        return None
    if is_number(test.operands[1]):
        found = answered(predicate(test), int(value), int(test.operands[1]))
        return None if found is None else bool(found)
    asked = renamed(test, {test.operands[0]: value})
    for label in sorted(flow.dominators[loop.header] - loop.blocks):
        end = flow.blocks[label].terminator
        known = flow.instruction(end.operands[0]) if len(set(flow.blocks[label].successors)) == 2 else None
        if known is None or known.opcode != "icmp":
            continue
        for way, holds in zip(flow.blocks[label].successors, (True, False), strict=True):
            leads = way in flow.dominators[loop.header] and flow.predecessors[way] == [label]
            if leads and (says := answer(flow, known, asked, holds=holds)) is not None:
                return says
    return None


def _with_ways(routine: Routine, kept: list[_Kept]) -> Routine:
    """Return `routine` with a block of its own on each way, on which its variables are set."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for before, way, _ in each.ways:
            put_between(blocks, before, each.chain[0], way)
        put_between(blocks, each.chain[-1], each.goal, each.onward)
        if each.goes_back:
            put_between(blocks, each.onward, each.goal, each.chain[-1] + BACK)
    return replace(routine, blocks=tuple(blocks.values()))


def _threaded(routine: Routine, kept: list[_Kept]) -> Routine:
    """Return `routine`, whose variables are in memory, with a copy of a chain for each way that needs one test less."""
    blocks = {each.label: each for each in routine.blocks}
    for each in kept:
        for _, way, copies in each.ways:
            blocks[way] = going_to(blocks[way], each.chain[0], copies[each.chain[0]])
            for label, copy in copies.items():
                blocks[copy] = _copy(blocks[label], copies, each.onward if label == each.chain[-1] else "")
    return replace(routine, blocks=tuple(blocks.values()))


def _copy(block: BasicBlock, copies: Mapping[str, str], goal: str) -> BasicBlock:
    """The copy of a block of a chain; `goal`: where it goes on to, if that is known."""
    label = copies[block.label]
    ending = label.rsplit(".", 1)[1]
    names = {each.result: f"{each.result}.{ending}" for each in block.instructions if each.result}
    rows = [renamed(replace(each, result=names.get(each.result or "")), names) for each in block.instructions]
    if goal:
        end = block.terminator
        rows[-1] = Instruction(None, "br", f"br label %{goal}", (), end.line, location=end.location)
    copy = replace(block, label=label, instructions=tuple(rows))
    for each in block.successors:
        copy = going_to(copy, each, copies.get(each, each))
    return copy


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
