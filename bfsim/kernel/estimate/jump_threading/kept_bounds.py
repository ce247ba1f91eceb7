"""Bounds that are not tested again after an iteration that leaves the number as it was [tree-ssa-threadbackward.cc of GCC 12].

In `while i < n and k < 100`, an iteration that does not count `k` ends with the test of `i` alone: `k < 100` held
before it. The same is true if it sets `k` to a number below 100. GCC copies the end of the loop for each such path to
it. If the bound is a variable, nothing is known: GCC's ranges are of numbers.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.estimate.jump_threading.known_ways import KnownWays, with_known_ways
from bfsim.kernel.estimate.jump_threading.threaded_choices import MOST_ON_A_WAY
from bfsim.kernel.estimate.ranges.value_ranges import answer
from bfsim.kernel.estimate.switches.copied_ways import answered
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import BasicBlock, Instruction, arms_of, is_number, predicate, renamed

CONDITION = 2
"""What a condition and its branch count of these [estimate_num_insns in tree-inline.cc]."""


def with_kept_bounds(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with such loop ends copied."""
    return with_known_ways(text, _each_kept)


def _each_kept(flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield such tests of a routine, none of them on a path to the chain of another."""
    seen, ends = set[str](), set[str]()
    for loop in flow.loops:
        for label in flow.inside(loop):
            kept = _kept(flow, loop, label) if label != loop.header and label not in seen else None
            if kept is not None and ends.isdisjoint(kept.before):
                ends.add(kept.chain[-1])
                yield kept
            seen.add(label)


def _kept(flow: ControlFlow, loop: Loop, label: str) -> KnownWays | None:
    """The test that some edges into a block of `loop` answer, in it or after a few others that only leave the loop."""
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
            return KnownWays(chain, goal, known, goal == loop.header)
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
    """The answer of a `test` of a number that is merged in block `label`, if control comes there from block `way`."""
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
    """The answer of a test of a number, by what is known of its bound where the loop begins."""
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
