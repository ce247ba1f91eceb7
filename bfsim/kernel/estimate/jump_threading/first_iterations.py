"""What only the first iteration of a loop is for is tested before it [pass_thread_jumps behind the loop passes, tree-ssa-threadbackward.cc of GCC 12].

`for x in range(n): if x > 0: ...`: whoever comes back to the test knows the answer, so the way back leads past it. The test is made once,
the loop begins behind it, and its end, which counts, stands in its middle. Where the way leads on is no place that each iteration passes,
little may be copied.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from bfsim.kernel.estimate.conditions.short_circuits import SECOND
from bfsim.kernel.estimate.jump_threading.known_ways import KnownWays, with_known_ways, with_one_way
from bfsim.kernel.estimate.jump_threading.threaded_choices import MOST_ON_A_WAY
from bfsim.kernel.estimate.loops.same_values import COMPUTED, is_same
from bfsim.kernel.estimate.ranges.value_ranges import LARGEST, LEAST, Range, value_range
from bfsim.kernel.estimate.switches.copied_ways import answered
from bfsim.kernel.ir.control_flow import COPIED, ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, is_number, predicate

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
WIDEST_STEP = 256
"""[ours] Of a counter that no loop brings so far that it wraps."""
TRUTHS = {"false": 0, "true": 1}


def with_first_iterations(text: str) -> str:
    """Return the module `text`, whose loops end with their tests, with tests before loops that only the first iteration needs."""
    text = with_known_ways(text, _each_first, _with_invariants_before, with_one_way)
    return with_known_ways(text, _each_entered, tidied=with_one_way)


def _each_first(flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield the tests of a routine that the first iteration of a loop alone needs."""
    for loop in flow.loops:
        back = [each for each in flow.predecessors[loop.header] if each in loop.blocks]
        if back == [loop.latch] and loop.latch != loop.header and not flow.is_split(loop):
            yield from _first(flow, loop, (loop.header,))


def _first(flow: ControlFlow, loop: Loop, chain: tuple[str, ...]) -> Iterator[KnownWays]:
    """The first such test behind a chain of blocks from the header on."""
    block = flow.blocks[chain[-1]]
    ways = block.successors
    if block.terminator.opcode != "br" or len(set(ways)) < 2 or _cost(flow, loop, chain) > MOST_ON_A_WAY:
        return
    again, first = (_answer(flow, loop, block.terminator.operands[0], source) for source in (True, False))
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
    return every or _cost(flow, loop, chain) * STATEMENTS <= (len(chain) + BEFORE) * BLOCKS


def _cost(flow: ControlFlow, loop: Loop, chain: tuple[str, ...]) -> int:
    """Statements that are copied: values that the loop carries, pointers too, but for the one that is tested, and what is computed.

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


def _with_invariants_before(routine: Routine, found: Iterable[KnownWays]) -> Routine:
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


def _each_entered(flow: ControlFlow) -> Iterator[KnownWays]:
    """Yield the tests that end loops which begin with them, where constants say that a loop goes on when it is come to."""
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
            continue  # LLVM had made one test of both, so they are at its end, or what begins it has been copied
        if len(before) == 1 and _cost(flow, loop, (loop.header,)) <= MOST_ON_A_WAY:
            condition = block.terminator.operands[0]
            said = None if _is_of_flag(flow, loop, condition) else _said_first(flow, loop, condition)
            if said is not None and ways[0 if said else 1] == inside[0]:
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
        and all(_constant(each) != (LEAST, LARGEST) for each in last.operands)
    )


def _said_first(flow: ControlFlow, loop: Loop, condition: str) -> bool | None:
    """What a test says in the first iteration of what is one step beyond its constant start."""
    test = flow.instruction(condition)
    if test is None or test.opcode != "icmp":
        return None
    counter, step = test.operands[0], 0
    made = flow.instruction(counter)
    if made is not None and made.opcode == "add" and is_number(made.operands[1]):
        counter, step = made.operands[0], int(made.operands[1])
    low, high = _range(flow, loop, counter, again=False)
    return (
        _said(predicate(test), (low + step, high + step), _constant(test.operands[1]))
        if low == high
        else None
    )


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


def _answer(flow: ControlFlow, loop: Loop, condition: str, again: bool) -> bool | None:
    """What a test of the loop's header says where that is come back to, or come to first."""
    test = flow.instruction(condition)
    if test is None:
        return None
    if test.opcode == "phi":
        low, high = _range(flow, loop, condition, again)
        return bool(low) if low == high else None
    if test.opcode != "icmp":
        return None
    return _said(predicate(test), *(_range(flow, loop, each, again) for each in test.operands[:2]))


def _said(relation: str, one: Range, other: Range) -> bool | None:
    """What a relation says of all values of two ranges; None if not the same of all."""
    if relation[0] == "u" and min(*one, *other) < 0:
        return None
    if relation in ("eq", "ne") and (one[1] < other[0] or other[1] < one[0]):
        return relation == "ne"
    corners = {answered(relation.replace("u", "s", 1), mine, theirs) for mine in one for theirs in other}
    is_point = one[0] == one[1] and other[0] == other[1]
    if len(corners) != 1 or (relation in ("eq", "ne") and not is_point):
        return None
    return bool(corners.pop())


def _range(flow: ControlFlow, loop: Loop, value: str, again: bool) -> Range:
    """The least and the largest that a value of the header may be, or anything that is known to be the same in all iterations."""
    if is_number(value):
        return int(value), int(value)
    if value in TRUTHS:
        return TRUTHS[value], TRUTHS[value]
    phi = flow.instruction(value)
    if phi is None or phi.opcode != "phi" or flow.defined[value][0] != loop.header:
        return LEAST, LARGEST
    arms = arms_of(phi)
    last = arms.pop(loop.latch)
    starts = [_constant(each) for each in arms.values()]
    low, high = min(low for low, _ in starts), max(high for _, high in starts)
    return _stepped(flow, loop, phi, last, (low, high)) if again else (low, high)


def _constant(value: str) -> Range:
    found = int(value) if is_number(value) else TRUTHS.get(value)
    return (LEAST, LARGEST) if found is None else (found, found)


def _stepped(flow: ControlFlow, loop: Loop, phi: Instruction, last: str, start: Range) -> Range:
    """The range of what a value of the header becomes: of a counter, beyond its start; of what is chosen, that of all choices."""
    if is_number(last) or last in TRUTHS:
        return _constant(last)
    each = flow.instruction(last)
    if each is None:
        return LEAST, LARGEST
    if each.opcode == "phi" and each is not phi:
        arms = [_constant(value) for value in each.operands]
        return min(low for low, _ in arms), max(high for _, high in arms)
    if each.opcode != "add" or each.operands[0] != phi.result or not is_number(each.operands[1]):
        return value_range(flow, last)
    step = int(each.operands[1])
    if abs(step) > WIDEST_STEP or not _ends(flow, loop, {phi.result, last}) or start == (LEAST, LARGEST):
        return LEAST, LARGEST
    return (start[0] + step, LARGEST) if step > 0 else (LEAST, start[1] + step)


def _ends(flow: ControlFlow, loop: Loop, names: set[str | None]) -> bool:
    """Whether a loop ends where a test of one of these says so, before that wraps."""
    tests = (flow.instruction(flow.blocks[each].terminator.operands[0]) for each in flow.exits(loop))
    return any(test is not None and test.opcode == "icmp" and names & {*test.operands} for test in tests)
