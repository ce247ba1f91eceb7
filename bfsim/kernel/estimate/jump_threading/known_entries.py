"""Loops that begin with a test whose answer is known on entry: the entry leads past it [pass_dominator, tree-ssa-threadupdate.cc of GCC 12].

`for x in range(n): if x < 2 or x >= n - 2: ...`: the first iteration goes to where the test leads, and the loop begins
there, with the end that counts in its middle.
"""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.estimate.conditions.short_circuits import SECOND
from bfsim.kernel.estimate.jump_threading.first_iterations import statements_copied, with_invariants_before
from bfsim.kernel.estimate.jump_threading.known_ways import KnownWays, with_known_ways, with_one_way
from bfsim.kernel.estimate.jump_threading.loop_answers import answer, constant, counts_anew, range_of, said
from bfsim.kernel.estimate.jump_threading.skipped_iterations import SKIPPED
from bfsim.kernel.estimate.jump_threading.threaded_choices import MOST_ON_A_WAY
from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.estimate.ranges.value_ranges import LARGEST, LEAST
from bfsim.kernel.ir.control_flow import COPIED, ControlFlow, Loop
from bfsim.kernel.ir.text import arms_of, is_number, predicate


def with_known_entries(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with such entries past the first tests of loops."""
    text = with_known_ways(text, _each_entered, tidied=with_one_way)
    return with_known_ways(text, _each_begun, with_invariants_before, with_one_way)


def _each_entered(flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield the tests that loops begin with and that end them, if constants say that a loop goes on when it is entered."""
    for loop in flow.loops:
        before = [each for each in flow.predecessors[loop.header] if each not in loop.blocks]
        block = flow.blocks[loop.header]
        ways = block.successors
        inside = [each for each in dict.fromkeys(ways) if each in loop.blocks]
        if (
            block.terminator.opcode != "br"
            or len(set(ways)) != 2
            or len(inside) != 1
            or loop.latch == loop.header
        ):
            continue
        if loop.inner or loop.latch.endswith(SECOND) or f"{loop.latch}{COPIED}" in flow.blocks:
            continue  # LLVM had joined both tests, so they are at its end, or its beginning has been copied
        if len(before) == 1 and statements_copied(flow, loop, (loop.header,)) <= MOST_ON_A_WAY:
            condition = block.terminator.operands[0]
            known = None if _is_of_flag(flow, loop, condition) else _said_first(flow, loop, condition)
            if known is not None and ways[0 if known else 1] == inside[0]:
                yield KnownWays((loop.header,), inside[0], tuple(before), goes_back=False)


def _is_of_flag(flow: ControlFlow, loop: Loop, condition: str) -> bool:
    """Whether a test is of what each way through the loop sets to a constant: all of them lead past it, the ways that end the loop out of it."""
    test = flow.instruction(condition)
    phi = flow.instruction(test.operands[0]) if test is not None and test.opcode == "icmp" else test
    if phi is None or phi.opcode != "phi" or flow.defined[phi.result or ""][0] != loop.header:
        return False
    last = flow.instruction(arms_of(phi)[loop.latch])
    return (
        last is not None
        and last.opcode == "phi"
        and all(constant(each) != (LEAST, LARGEST) for each in last.operands)
    )


def _said_first(flow: ControlFlow, loop: Loop, condition: str) -> bool | None:
    """The answer of a test in the first iteration, of a value one step beyond its constant start."""
    test = flow.instruction(condition)
    if test is None or test.opcode != "icmp":
        return None
    counter, step = test.operands[0], 0
    made = flow.instruction(counter)
    if made is not None and made.opcode == "add" and is_number(made.operands[1]):
        counter, step = made.operands[0], int(made.operands[1])
    low, high = range_of(flow, loop, counter, again=False)
    return (
        said(predicate(test), (low + step, high + step), constant(test.operands[1])) if low == high else None
    )


def _each_begun(flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield the tests that only begin loops, if their answer is known in the first iteration alone.

    Each iteration passes the block that they lead to then, so the loop begins there
    [fwd_jt_path_registry::thread_through_loop_header].
    """
    for loop in flow.loops:
        before = [each for each in flow.predecessors[loop.header] if each not in loop.blocks]
        block = flow.blocks[loop.header]
        if block.terminator.opcode != "br" or len(set(block.successors)) != 2 or flow.is_split(loop):
            continue
        first, again = (answer(flow, loop, block.terminator.operands[0], each) for each in (False, True))
        if first is None or again is not None or not _only_tests(flow, loop) or counts_anew(flow, loop):
            continue
        goal = block.successors[0 if first else 1]
        if any(way.endswith(SKIPPED) for way in block.successors):
            continue  # the goal has been threaded to before, and begins with a separate block
        if goal == loop.latch and not any(each.opcode == "store" for each in flow.blocks[goal].instructions):
            continue  # it does nothing but step: the loop would have two ways back
        if loop.blocks.issuperset(block.successors) and _is_passed(flow, loop, goal):
            yield KnownWays((loop.header,), goal, tuple(before), goes_back=False)


def _is_passed(flow: ControlFlow, loop: Loop, goal: str) -> bool:
    """Whether each iteration passes a block, no step before it: of a choice that one way to it knows the step of, each way steps its own [pass_pre]."""
    steps = [
        flow.instruction(each.operands[0])
        for each in flow.blocks[goal].instructions
        if each.opcode == "add" and is_number(each.operands[1])
    ]
    chosen = [
        each
        for each in steps
        if each is not None and each.opcode == "phi" and flow.defined[each.result or ""][0] == goal
    ]
    return goal in flow.dominators[loop.latch] and not any(
        _is_stepped(flow, value) for each in chosen for value in each.operands
    )


def _is_stepped(flow: ControlFlow, value: str) -> bool:
    made = flow.instruction(value)
    return is_number(value) or (made is not None and made.opcode == "add" and is_number(made.operands[1]))


def _only_tests(flow: ControlFlow, loop: Loop) -> bool:
    """Whether the first block of a loop computes nothing else that changes in it [redirection_block_p in tree-ssa-threadupdate.cc]."""
    rows = flow.blocks[loop.header].instructions[:-1]
    test = flow.instruction(flow.blocks[loop.header].terminator.operands[0])
    return all(each.opcode == "phi" or each is test or is_same(flow, loop, each) for each in rows)
