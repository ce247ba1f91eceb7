"""Final values: a counter that is wanted behind its loop is what it was compared with [final_value_replacement_loop in tree-scalar-evolution.cc of GCC 12].

`while i < n: ...; i += 1` ends with `i == n`. So the loop need not step `i` if it only finds elements with it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from bfsim.kernel.ir_text import NAME, BasicBlock, Instruction, Routine, arms_of, predicate
from bfsim.kernel.loops import ControlFlow, Loop

STEPS = {"1": ("lt", "gt"), "-1": ("gt", "lt")}
"""The relation of a counter to its bound while the loop goes on, by its step, and of the bound to the counter."""


@dataclass(frozen=True, slots=True)
class Final:
    """A stepped counter of `loop` that is `bound` behind it."""

    loop: Loop
    step: str
    bound: str


def with_final_values(routine: Routine) -> Routine:
    """Return `routine` with the bound in place of each such counter behind its loop."""
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        flow = ControlFlow(routine)
        loop = next(each for each in flow.loops if each.header == header)
        final = _final(flow, loop)
        if final is not None:
            routine = replace(routine, blocks=tuple(_behind(block, final) for block in routine.blocks))
    return routine


def _final(flow: ControlFlow, loop: Loop) -> Final | None:
    if flow.exits(loop) != [loop.latch] or flow.is_split(loop):
        return None
    end = flow.blocks[loop.latch]
    test = flow.instruction(end.terminator.operands[0]) if end.terminator.operands else None
    if test is None or test.opcode != "icmp" or end.successors[0] not in loop.blocks:
        return None
    step, bound = test.operands[:2]
    stepped = flow.instruction(step)
    if stepped is None or stepped.opcode != "add" or not flow.is_invariant(bound, loop):
        return None
    counter = flow.instruction(stepped.operands[0])
    if counter is None or counter.opcode != "phi" or flow.defined[counter.result or ""][0] != loop.header:
        return None
    arms = arms_of(counter)
    relation, by = predicate(test), stepped.operands[1]
    if set(arms) != {flow.entering(loop), loop.latch} or arms[loop.latch] != step or by not in STEPS:
        return None
    if relation != "ne" and (
        relation[1:] != STEPS[by][0]
        or not _is_guarded(flow, loop, arms[flow.entering(loop)], bound, relation)
    ):
        return None
    return Final(loop, step, bound)


def _is_guarded(flow: ControlFlow, loop: Loop, start: str, bound: str, relation: str) -> bool:
    """Whether the loop is only come to if its test holds of the counter's first value."""
    turned = relation[0] + {"lt": "gt", "gt": "lt"}[relation[1:]]
    for label in flow.dominators[loop.header] - loop.blocks:
        ways = flow.blocks[label].successors
        terminator = flow.blocks[label].terminator
        test = (
            flow.instruction(terminator.operands[0])
            if terminator.opcode == "br" and terminator.operands
            else None
        )
        if test is None or test.opcode != "icmp" or len(set(ways)) != 2:
            continue
        holds = (predicate(test), *test.operands[:2]) in ((relation, start, bound), (turned, bound, start))
        before = [each for each in flow.predecessors[ways[0]] if each not in loop.blocks]
        if holds and ways[0] in flow.dominators[loop.header] and before == [label]:
            return True
    return False


def _behind(block: BasicBlock, final: Final) -> BasicBlock:
    if block.label in final.loop.blocks:
        return block
    rows = (_replaced(each, final) for each in block.instructions)
    return replace(block, instructions=tuple(rows))


def _replaced(each: Instruction, final: Final) -> Instruction:
    if final.step not in each.operands:
        return each
    text = NAME.sub(lambda found: final.bound if found[0] == final.step else found[0], each.text)
    operands = tuple(final.bound if value == final.step else value for value in each.operands)
    return replace(each, text=text, operands=operands)
