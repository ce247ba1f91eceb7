"""Operations that the previous iteration has already done: partial redundancy elimination [do_pre_regular_insertion in tree-ssa-pre.cc of GCC 12].

In `mean += a[i] - (mean >> 4); out[i] = mean >> 4`, an iteration shifts once: the result of its first shift was stored
in the iteration before, and is carried in a register.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, is_number, phi_of, renamed
from bfsim.kernel.ir.widths import WORD

OPERATIONS = ("ashr", "lshr", "shl", "and", "mul")
SAME_OF_ZERO = "0"
"""What all of these give of it."""


@dataclass(frozen=True, slots=True)
class _Carried:
    """An operation on the value that `phi` carries; `following`: the result of the same operation on its next value."""

    loop: Loop
    each: Instruction
    phi: Instruction
    following: str


def with_carried_operations(routine: Routine) -> Routine:
    """Return `routine` with such operations as phis, and the first ones before their loops."""
    flow = ControlFlow(routine)
    found = next((carried for loop in flow.loops for carried in _carried(flow, loop)), None)
    return routine if found is None else with_carried_operations(_moved(flow, routine, found))


def _carried(flow: ControlFlow, loop: Loop) -> Iterator[_Carried]:
    if set(flow.predecessors[loop.header]) != {flow.entering(loop), loop.latch}:
        return
    phis = {each.result: each for each in flow.blocks[loop.header].instructions if each.opcode == "phi"}
    for label in flow.inside(loop):
        for each in flow.blocks[label].instructions if flow.every_iteration(label, loop) else ():
            phi = phis.get(each.operands[0]) if each.opcode in OPERATIONS and each.bits == WORD else None
            if phi is None or not _is_fixed(flow, loop, each.operands[1], arms_of(phi)[flow.entering(loop)]):
                continue
            following = _same(flow, loop, each, arms_of(phi)[loop.latch])
            if following is not None:
                yield _Carried(loop, each, phi, following)


def _is_fixed(flow: ControlFlow, loop: Loop, operand: str, start: str) -> bool:
    """Whether the other operand is the same in all iterations, and available before the loop if the first value needs it."""
    made = flow.instruction(operand)
    same = made is not None and is_same(flow, loop, made)
    return flow.is_invariant(operand, loop) or (same and start == SAME_OF_ZERO)


def _same(flow: ControlFlow, loop: Loop, each: Instruction, value: str) -> str | None:
    """The instruction that does the same to another value in each iteration, if there is one."""
    for label in flow.inside(loop):
        for other in flow.blocks[label].instructions if flow.every_iteration(label, loop) else ():
            is_same = other.operands == (value, each.operands[1]) and other.bits == each.bits
            if is_same and other is not each and (other.opcode == each.opcode or _is_cut(flow, other)):
                return other.result
    return None


def _is_cut(flow: ControlFlow, shift: Instruction) -> bool:
    """Whether no wanted bit of a right shift depends on whether it keeps the sign: LLVM takes the one that does not."""
    if shift.opcode != "lshr" or not is_number(shift.operands[1]):
        return False
    left = WORD - int(shift.operands[1])
    return all(
        user.opcode == "trunc" and int(user.text.rsplit(" i", 1)[1]) <= left
        for user in flow.users[shift.result or ""]
    )


def _moved(flow: ControlFlow, routine: Routine, carried: _Carried) -> Routine:
    loop, each, phi = carried.loop, carried.each, carried.phi
    entering, name = flow.entering(loop), f"{each.result}.along"
    start = arms_of(phi)[entering]
    first, rows = SAME_OF_ZERO, list[Instruction]()
    if start != SAME_OF_ZERO:
        first = f"{each.result}.first"
        rows.append(replace(_of(each, phi.result or "", start), result=first))
    along = phi_of(name, f"i{WORD}", ((first, entering), (carried.following, loop.latch)), each)
    blocks = []
    for block in routine.blocks:
        kept = [
            _like(each, one) if one.result == carried.following else renamed(one, {each.result or "": name})
            for one in block.instructions
            if one is not each
        ]
        if block.label == entering:
            kept[-1:-1] = rows
        blocks.append(replace(block, instructions=(*([along] if block.label == loop.header else []), *kept)))
    return replace(routine, blocks=tuple(blocks))


def _like(each: Instruction, other: Instruction) -> Instruction:
    """The same operation as `each` on the operand of `other`."""
    text = other.text.replace(other.opcode, each.opcode, 1)
    return replace(other, opcode=each.opcode, text=text)


def _of(each: Instruction, value: str, other: str) -> Instruction:
    """An operation on another value, which may be a number."""
    if is_number(other):
        text = each.text.replace(f" {value},", f" {other},", 1)
        return replace(each, text=text, operands=(other, each.operands[1]))
    return renamed(each, {value: other})
