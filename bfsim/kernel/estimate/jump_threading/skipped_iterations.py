"""Iterations that a `continue` skips for one value of the counter: the counter takes its next value at once.

`for dx in range(-1, 2): if dx == 0 and dy == 0: continue`: after the test, GCC 12 knows the counter, that the loop goes
on and that the test will not hold again, and threads the jump through the end of the loop [tree-ssa-threadbackward.cc].
So the counter is set to 1 and the iteration goes on; two tests for 0 become one of `dx | dy`
[optimize_range_tests_cmp_bitwise in tree-ssa-reassoc.cc]. The loop is no longer counted, nor unrolled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from operator import ge, gt, le, lt, ne

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.edges import without_way
from bfsim.kernel.ir.reading import read_module
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    phi_of,
    predicate,
    renamed,
)
from bfsim.kernel.ir.writing import with_names, write_module

SKIPPED = ".skipped"
"""Ends the label of the block that moves the counter on."""

HOLDS: dict[str, Callable[[int, int], bool]] = {
    "ne": ne,
    "slt": lt,
    "sle": le,
    "sgt": gt,
    "sge": ge,
    "ult": lt,
    "ule": le,
    "ugt": gt,
    "uge": ge,
}
"""The relations of unsigned numbers that do the same if neither number is negative."""
IDLE = ("phi", "add", "icmp", "br")


@dataclass(frozen=True, slots=True)
class _Skip:
    """The tests of a loop's `header`, one block each, that skip an iteration for one value of `counter`, which then becomes `following`."""

    header: str
    tests: tuple[str, ...]
    counter: Instruction
    following: int
    goes_on: str
    is_one_test: bool


def with_skipped_iterations(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with such jumps threaded."""
    text = with_names(text)
    return write_module(text, [_threaded(each) for each in read_module(text)])


def _threaded(routine: Routine) -> Routine:
    flow = ControlFlow(routine)
    for loop in flow.loops:
        skip = _skip(flow, loop)
        if skip is not None:
            return _threaded(_set_on(flow, routine, loop, skip))
    return routine


def _skip(flow: ControlFlow, loop: Loop) -> _Skip | None:
    labels = [loop.header]
    if loop.inner or flow.exits(loop) != [loop.latch] or _test(flow, loop.header) is None:
        return None
    if flow.blocks[loop.header].successors[0] != loop.latch:
        labels.append(flow.blocks[loop.header].successors[0])
    tests = [each for each in (_test(flow, label) for label in labels) if each is not None]
    ways = [flow.blocks[label].successors for label in labels]
    if len(tests) < len(labels) or [way[0] for way in ways] != [*labels[1:], loop.latch]:
        return None
    (behind, *others) = {way[1] for way in ways}
    if others or behind in (loop.latch, *labels) or set(flow.predecessors[behind]) != set(labels):
        return None
    if any(each.opcode == "phi" for each in flow.blocks[behind].instructions):
        return None
    for each in tests:
        counter = flow.instruction(each.operands[0])
        following = _following(flow, loop, labels[-1], counter, int(each.operands[1])) if counter else None
        if counter is not None and following is not None:
            is_one_test = len(tests) > 1 and all(test.operands[1] == "0" for test in tests)
            return _Skip(loop.header, tuple(labels), counter, following, behind, is_one_test)
    return None


def _test(flow: ControlFlow, label: str) -> Instruction | None:
    """The test for a number, if there is nothing else in a block."""
    block = flow.blocks[label]
    tests = block.terminator.opcode == "br" and block.terminator.operands
    test = flow.instruction(block.terminator.operands[0]) if tests else None
    others = [each for each in block.instructions if each.opcode != "phi" and each is not test]
    if test is None or others != [block.terminator] or block.enters or test.opcode != "icmp":
        return None
    return test if predicate(test) == "eq" and is_number(test.operands[1]) else None


def _following(flow: ControlFlow, loop: Loop, label: str, counter: Instruction, number: int) -> int | None:
    """The counter in the iteration after the one that is skipped from block `label`, if nothing else happens in between."""
    latch = flow.blocks[loop.latch]
    if (
        flow.defined[counter.result or ""] != (loop.header, counter)
        or counter.opcode != "phi"
        or latch.enters
    ):
        return None
    step = flow.instruction(arms_of(counter)[loop.latch])
    end = flow.instruction(latch.terminator.operands[0])
    if (
        step is None
        or step.opcode != "add"
        or step.operands[0] != counter.result
        or end is None
        or end.opcode != "icmp"
    ):
        return None
    if not all(map(is_number, (step.operands[1], end.operands[1]))) or predicate(end) not in HOLDS:
        return None
    following = number + int(step.operands[1])
    known = {counter.result: number, step.result: following}
    if any(each.opcode not in IDLE for each in latch.instructions) or end.operands[0] not in known:
        return None
    counted, last = known[end.operands[0]], int(end.operands[1])
    if predicate(end).startswith("u") and min(counted, last) < 0:
        return None
    again = HOLDS[predicate(end)](counted, last)
    others = [
        each for each in flow.blocks[loop.header].instructions if each.opcode == "phi" and each is not counter
    ]
    still = all(_there(flow, loop, label, each) == each.result for each in others)
    return following if again == (latch.successors[0] == loop.header) and still else None


def _there(flow: ControlFlow, loop: Loop, label: str, phi: Instruction) -> str:
    """The next value of a loop's value after the skipped iteration."""
    value = arms_of(phi)[loop.latch]
    source = flow.instruction(value)
    merged = source is not None and source.opcode == "phi" and flow.defined[value][0] == loop.latch
    return arms_of(source)[label] if source is not None and merged else value


def _set_on(flow: ControlFlow, routine: Routine, loop: Loop, skip: _Skip) -> Routine:
    name = skip.counter.result or ""
    now, setting = f"{name}.on", f"{skip.header}{SKIPPED}"
    line, location = skip.counter.line, skip.counter.location
    jump = Instruction(None, "br", f"br label %{skip.goes_on}", (), line, location=location)
    tests = skip.tests[:1] if skip.is_one_test else skip.tests
    arms = [(str(skip.following), setting), *((name, label) for label in tests)]
    phi = phi_of(now, "i32", arms, skip.counter)
    blocks = []
    for block in routine.blocks:
        rows = list(block.instructions)
        if block.label in skip.tests:
            if skip.is_one_test and block.label != skip.header:
                continue
            if skip.is_one_test:
                rows = _joined(flow, skip, rows, setting)
            elif block.label == skip.tests[-1]:
                rows[-1] = replace(
                    rows[-1], text=rows[-1].text.replace(f"label %{loop.latch},", f"label %{setting},")
                )
            if block.label == skip.header:
                rows = [renamed(each, {name: now}) if each.opcode == "phi" else each for each in rows]
        elif block.label in loop.blocks:
            rows = [without_way(each, skip.tests[-1]) if block.label == loop.latch else each for each in rows]
            rows = [renamed(each, {name: now}) for each in rows]
        blocks.append(replace(block, instructions=(*[phi] * (block.label == skip.goes_on), *rows)))
        if block.label == tests[-1]:
            blocks.append(BasicBlock(setting, (jump,)))
    return replace(routine, blocks=tuple(blocks))


def _joined(flow: ControlFlow, skip: _Skip, rows: list[Instruction], setting: str) -> list[Instruction]:
    """Both tests for 0 as one, at the end of the header."""
    tests = [flow.instruction(flow.blocks[label].terminator.operands[0]) for label in skip.tests]
    values = tuple(each.operands[0] for each in tests if each is not None)
    both, none, branch = f"{skip.counter.result}.both", f"{skip.counter.result}.none", rows[-1]
    rows = [each for each in rows[:-1] if each is not tests[0] or flow.users[each.result or ""] != [branch]]
    text = f"br i1 {none}, label %{setting}, label %{skip.goes_on}"
    return [
        *rows,
        replace(branch, result=both, opcode="or", text=f"or i32 {values[0]}, {values[1]}", operands=values),
        replace(branch, result=none, opcode="icmp", text=f"icmp eq i32 {both}, 0", operands=(both, "0")),
        replace(branch, text=text, operands=(none,)),
    ]
