"""Tests that LLVM has joined, as two branches again, like `and` and `or` in the source.

GCC joins the tests of `a and b` only if branches are expensive [LOGICAL_OP_NON_SHORT_CIRCUIT in fold-const.cc of GCC
12]; for the Blackfin their cost is the least there is [BRANCH_COST in defaults.h, which bfin.h leaves as it is].
"""

from __future__ import annotations

import re
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, each_arm, with_each_arm

SECOND = ".second"  # ending of the label of the block with the second test
JOINED = re.compile(r"select i1 \S+, i1 (\S+), i1 (\S+)$")


def split_tests(routine: Routine) -> Routine:
    """Return `routine` with a separate block for the second part of each such test."""
    flow = ControlFlow(routine)
    for block in routine.blocks:
        joined = _joined(flow, block)
        parts = _parts(joined) if joined is not None else None
        if joined is not None and parts is not None:
            return split_tests(_split(flow, block, joined, *parts))
    return routine


def _joined(flow: ControlFlow, block: BasicBlock) -> Instruction | None:
    """The condition of the branch at the end of a block, if it is computed there and has no other use."""
    if block.terminator.opcode != "br" or len(set(block.successors)) != 2:
        return None
    test = flow.instruction(block.terminator.operands[0])
    alone = test is not None and flow.users[test.result or ""] == [block.terminator]
    return test if alone and any(each is test for each in block.instructions) else None


def _parts(joined: Instruction) -> tuple[str, str, bool] | None:
    """The two conditions that are joined, in the order of the source, and whether both must hold."""
    if joined.opcode in ("and", "or") and joined.bits == 1:
        return joined.operands[0], joined.operands[1], joined.opcode == "and"
    found = JOINED.match(joined.text)
    if found and found[2] == "false":
        return joined.operands[0], found[1], True
    if found and found[1] == "true":
        return joined.operands[0], found[2], False
    return None


def _split(
    flow: ControlFlow, block: BasicBlock, joined: Instruction, first: str, second: str, both: bool
) -> Routine:
    yes, no = block.successors
    branch, name = block.terminator, f"{block.label}{SECOND}"
    while name in flow.blocks:
        name += SECOND
    early = no if both else yes
    moved = _needed_by(flow, block, joined, second)
    rest = [
        each
        for each in block.instructions[:-1]
        if each is not joined and not any(each is other for other in moved)
    ]
    ways = (name, no) if both else (yes, name)
    here = replace(branch, text=f"br i1 {first}, label %{ways[0]}, label %{ways[1]}", operands=(first,))
    there = replace(branch, text=f"br i1 {second}, label %{yes}, label %{no}", operands=(second,))
    blocks: list[BasicBlock] = []
    for each in flow.routine.blocks:
        rows = [*rest, here] if each is block else [*each.instructions]
        if each.label in (yes, no):
            rows = [_with_arm(row, block.label, name, keeps=each.label == early) for row in rows]
        blocks.append(replace(each, instructions=tuple(rows)))
        if each is block:
            blocks.append(BasicBlock(name, (*moved, there)))
    return replace(flow.routine, blocks=tuple(blocks))


def _needed_by(flow: ControlFlow, block: BasicBlock, joined: Instruction, test: str) -> list[Instruction]:
    """What only the second test needs, in order: C computes it after the first one."""
    moved: list[Instruction] = []
    written = False
    for each in reversed(block.instructions[:-1]):
        written |= each.opcode == "store" or each.is_call
        if each is joined or each.opcode in ("phi", "store", "call") or (each.opcode == "load" and written):
            continue
        users = [user for user in flow.users.get(each.result or "", []) if user is not joined]
        wanted = each.result == test or bool(users)
        if wanted and all(any(user is other for other in moved) for user in users):
            moved.insert(0, each)
    return moved


def _with_arm(row: Instruction, label: str, second: str, *, keeps: bool) -> Instruction:
    """A phi with the value from `second` besides that from `label`, or instead of it."""
    if row.opcode != "phi":
        return row
    arms = []
    for value, source in each_arm(row):
        if source != label or keeps:
            arms.append((value, source))
        if source == label:
            arms.append((value, second))
    return with_each_arm(row, arms)
