"""What only the first iteration of a loop is for is tested before it [pass_thread_jumps behind the loop passes, tree-ssa-threadbackward.cc of GCC 12].

`for x in range(n): if x > 0: ...`: whoever comes back to the test knows the answer, so the way back leads past it. The test is made once,
the loop begins behind it, and its end, which counts, stands in its middle. Where the way leads on is no place that each iteration passes,
little may be copied.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

from bfsim.kernel.estimate.induction_variables.elimination import pointed_counters
from bfsim.kernel.estimate.jump_threading.known_ways import KnownWays, with_known_ways, with_one_way
from bfsim.kernel.estimate.jump_threading.loop_answers import answer
from bfsim.kernel.estimate.jump_threading.threaded_choices import MOST_ON_A_WAY
from bfsim.kernel.estimate.loops.same_values import COMPUTED, is_same
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, Routine, arms_of
from bfsim.kernel.profile import CompilerProfile

BEFORE = 2
"""Blocks on the way before the header: the one that ends the loop, and an empty one behind it."""
BLOCKS, STATEMENTS = 3, 2
"""How many statements so many blocks may copy where that makes a loop of two entrances [param_fsm_scale_path_blocks, param_fsm_scale_path_stmts]."""
ACCESS = 2
"""Statements of an access: itself, and the step of its pointer."""
CONDITION = 2
"""What a condition and its branch count of that."""
STEPPED = ("add", "sub", "shl", "getelementptr", "phi")
"""What is computed from a counter and goes along with it."""


def with_first_iterations(text: str, profile: CompilerProfile) -> str:
    """Return the module `text`, whose loops end with their tests, with tests before loops that only the first iteration needs."""
    return with_known_ways(text, partial(_each_first, profile), with_invariants_before, with_one_way)


def _each_first(profile: CompilerProfile, flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield the tests of a routine that the first iteration of a loop alone needs: not those of a counter that a pointer stands for by then."""
    pointed = pointed_counters(flow, profile)
    for loop in flow.loops:
        back = [each for each in flow.predecessors[loop.header] if each in loop.blocks]
        if back == [loop.latch] and loop.latch != loop.header and not flow.is_split(loop):
            yield from (
                each
                for each in _first(flow, loop, (loop.header,))
                if pointed.isdisjoint(_compared(flow, each))
            )


def _compared(flow: ControlFlow, known: KnownWays) -> tuple[str, ...]:
    """What the test at the end of a chain compares."""
    test = flow.instruction(flow.blocks[known.chain[-1]].terminator.operands[0])
    return test.operands if test is not None else ()


def _first(flow: ControlFlow, loop: Loop, chain: tuple[str, ...]) -> Iterator[KnownWays]:
    """The first such test behind a chain of blocks from the header on."""
    block = flow.blocks[chain[-1]]
    ways = block.successors
    if (
        block.terminator.opcode != "br"
        or len(set(ways)) < 2
        or statements_copied(flow, loop, chain) > MOST_ON_A_WAY
    ):
        return
    again, first = (answer(flow, loop, block.terminator.operands[0], source) for source in (True, False))
    if again is not None and again != first:
        goal = ways[0 if again else 1]
        if goal in loop.blocks and _may_copy(flow, loop, chain, goal):
            begins = None if first is None else int(not first)
            yield KnownWays(chain, goal, (loop.latch,), goes_back=False, begins=begins)
        return
    for way in ways:
        if way in loop.blocks and flow.predecessors[way] == [chain[-1]] and way != loop.latch:
            yield from _first(flow, loop, (*chain, way))


def _may_copy(flow: ControlFlow, loop: Loop, chain: tuple[str, ...], goal: str) -> bool:
    every = goal in flow.dominators[loop.latch]
    return every or statements_copied(flow, loop, chain) * STATEMENTS <= (len(chain) + BEFORE) * BLOCKS


def statements_copied(flow: ControlFlow, loop: Loop, chain: tuple[str, ...]) -> int:
    """Return how many statements are copied: values that the loop carries, pointers too, but for the one that is tested, and what is computed.

    Where a sum of the counter is computed, that may be what is tested.
    """
    carried = {each.result for each in flow.blocks[loop.header].instructions if each.opcode == "phi"}
    rows = [each for label in chain for each in flow.blocks[label].instructions]
    is_other = any(each.opcode == "add" and each.operands[0] in carried for each in rows)
    accesses = sum(each.opcode in ("load", "store") for each in rows)
    computed = sum(
        each.opcode in COMPUTED and each.opcode != "getelementptr" and not is_same(flow, loop, each)
        for each in rows
    )
    return (
        len(carried)
        - (not is_other)
        + len(_walked(flow, loop))
        + ACCESS * accesses
        + computed
        + CONDITION * (len(chain) - 1)
    )


def with_invariants_before(routine: Routine, found: Iterable[KnownWays]) -> Routine:
    """Return `routine`, in which nothing is copied with the tests that are the same in all iterations: it is computed before."""
    flow = ControlFlow(routine)
    blocks = dict(flow.blocks)
    for test in found:
        loop = next(each for each in flow.loops if each.header == test.chain[0])
        rows = [
            each for label in test.chain for each in blocks[label].instructions if is_same(flow, loop, each)
        ]
        before = blocks[flow.entering(loop)]
        *own, end = before.instructions
        blocks[before.label] = replace(before, instructions=(*own, *rows, end))
        for label in test.chain:
            kept = tuple(each for each in blocks[label].instructions if each not in rows)
            blocks[label] = replace(blocks[label], instructions=kept)
    return replace(routine, blocks=tuple(blocks.values()))


def _walked(flow: ControlFlow, loop: Loop) -> set[str]:
    """Arrays that a loop walks along: what it carries counts for an index."""
    counters = {
        name
        for each in flow.blocks[loop.header].instructions
        if each.opcode == "phi" and _is_counter(flow, loop, each)
        for name in (each.result or "", arms_of(each)[loop.latch])
    }
    walked = set[str]()
    for label in flow.inside(loop):
        for each in flow.blocks[label].instructions:
            if each.opcode in STEPPED and counters & {*each.operands}:
                counters.add(each.result or "")
                if each.opcode == "getelementptr":
                    walked.add(flow.root(each.operands[0]))
    return walked


def _is_counter(flow: ControlFlow, loop: Loop, phi: Instruction) -> bool:
    step = flow.instruction(arms_of(phi)[loop.latch])
    return step is not None and step.opcode == "add" and step.operands[0] == phi.result
