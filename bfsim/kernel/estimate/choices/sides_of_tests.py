"""Operations on each side of a test, computed there: LLVM makes one operation after both, on a choice of their operands.

GCC makes a branch of `s += v` on one side and `s -= 1` on the other [factor_out_conditional_conversion in
tree-ssa-phiopt.cc takes only conversions]; of the choice it would have made a conditional move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, phi_of, renamed

OPERATIONS = ("add", "sub", "mul", "and", "or", "xor", "shl", "lshr", "ashr")
CHOSEN = ".pn"  # ends the names of such choices [foldPHIArgBinOpIntoPHI in LLVM's InstCombinePHI.cpp]
UNEXTENDED = f"{CHOSEN}.in"  # and those of narrow ones, which are extended then


def with_operations_on_sides(routine: Routine) -> Routine:
    """Return `routine` with such operations on their sides again."""
    while True:
        flow = ControlFlow(routine)
        choices = (each for block in routine.blocks for each in block.instructions if each.opcode == "phi")
        found = next(((each, moved) for each in choices if (moved := _made_of(flow, each))), None)
        if found is None:
            return routine
        routine = _on_sides(flow, *found)


def _made_of(flow: ControlFlow, choice: Instruction) -> list[Instruction]:
    """Return what LLVM has made of the operations of both sides: one on a choice, or on its extension; empty if it is no such choice."""
    name = choice.result or ""
    home = flow.defined[name][0]
    ways = {label: flow.blocks[label].successors for label in arms_of(choice)}
    if home in ways or any(each.count(home) != 1 for each in ways.values()):
        return []
    found = list[Instruction]()
    if name.endswith(UNEXTENDED):
        found = _alone(flow, name, home, ("sext", "zext"))
        name = found[0].result or "" if found else ""
    last = _alone(flow, name, home, OPERATIONS) if name.endswith(CHOSEN) else []
    others = [
        flow.defined.get(each, ("", choice))[0] for one in last for each in one.operands if each != name
    ]
    return [*found, *last] if last and home not in others else []


def _alone(flow: ControlFlow, name: str, home: str, opcodes: Sequence[str]) -> list[Instruction]:
    """Return the only use of a value, if it is one of these operations in the same block."""
    users = flow.users.get(name, [])
    is_one = len(users) == 1 and users[0].opcode in opcodes and flow.defined[users[0].result or ""][0] == home
    return users if is_one else []


def _on_sides(flow: ControlFlow, choice: Instruction, moved: Sequence[Instruction]) -> Routine:
    """Move operations to the edges into the block that has them."""
    home, last = flow.defined[choice.result or ""][0], moved[-1]
    blocks, results = dict(flow.blocks), dict[str, str]()
    arms = arms_of(choice)
    for number, (label, value) in enumerate(arms.items()):
        side, names = label, {choice.result or "": value}
        if not arms.keys().isdisjoint(
            blocks[label].successors
        ):  # the other side of a test has no block left here
            side = f"{label}.on.{home}"
            put_between(blocks, label, home, side)
        *rows, end = blocks[side].instructions
        for each in moved:
            # with a word between, for LLVM numbers the copies of a loop's turns without one
            own = f"{each.result}.on.{number}"
            rows.append(replace(renamed(each, names), result=own))
            names[each.result or ""] = own
        results[side] = names[last.result or ""]
        blocks[side] = replace(blocks[side], instructions=(*rows, end))
    phi = phi_of(last.result or "", f"i{last.bits}", ((value, side) for side, value in results.items()), last)
    gone = {choice.result, *(each.result for each in moved)}
    rows = [each for each in blocks[home].instructions if each.result not in gone or each.result is None]
    blocks[home] = replace(blocks[home], instructions=(phi, *rows))
    return replace(flow.routine, blocks=tuple(blocks.values()))
