"""Which choices become conditional moves: those whose register is not tested, and that copy at most one value.

GCC 12 takes an `if` for conditional moves if its arms only copy [cond_move_process_if_block in ifcvt.cc]. It does not if the condition
uses the register that they copy to [check_cond_move_block], nor if both arms copy from a register. A value that is not
used after the choice is already in the choice's register: it is not copied, and if it is tested, so is that register.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.estimate.choices.narrow_choices import is_computed_narrow, stored_bits
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, arms_of, is_number
from bfsim.kernel.ir.widths import WORD

CASTS = ("trunc", "zext", "sext", "freeze")
MOST_ON_ONE_SIDE = 2
"""The most registers that only one side of a test sets [MAX_CONDITIONAL_EXECUTE in ifcvt.cc, where a branch costs 1]."""


def is_conditional_move(
    flow: ControlFlow, phi: Instruction, values: tuple[str, str], tested: frozenset[str]
) -> bool:
    """Whether the choice `phi` between two `values` becomes one, after a comparison of those in `tested`."""
    if _is_narrow(flow, phi, values) and not (
        tested.issuperset(values) and _stays_a_branch(flow, phi, values)
    ):
        tested = frozenset()  # wide, in a separate register
    own, copied = _registers(flow, phi, values, tested)
    return len(copied) < 2 and tested.isdisjoint(own)


def are_conditional_moves(
    flow: ControlFlow, choices: Sequence[tuple[Instruction, str, str]], tested: frozenset[str]
) -> bool:
    """Whether choices by one comparison, each a phi and its value on either side, become them: no value may be overwritten by another choice.

    If two choose between numbers with the same distance, LLVM has computed one from the other; in C it is no choice.
    """
    if not all(is_conditional_move(flow, phi, (yes, no), tested) for phi, yes, no in choices):
        return False
    registers = [_registers(flow, phi, (yes, no), tested) for phi, yes, no in choices]
    apart = [int(yes) - int(no) for _, yes, no in choices if is_number(yes) and is_number(no)]
    if len({*apart}) < len(apart) or len(choices) - len(apart) > MOST_ON_ONE_SIDE:
        return False
    return all(
        own.isdisjoint(copied)
        for number, (own, _) in enumerate(registers)
        for other, (_, copied) in enumerate(registers)
        if number != other
    )


def _registers(
    flow: ControlFlow, phi: Instruction, values: tuple[str, str], tested: frozenset[str]
) -> tuple[set[str], set[str]]:
    """The values that share the register of a choice, and those that are copied to it."""
    carried = {each for each in _carried(flow, phi) if not _is_wanted_behind(flow, each, phi)}
    registers = [each for each in values if each.startswith("%")]
    free = [each for each in registers if not _is_wanted_behind(flow, each, phi)]
    sharing = sorted(free, key=lambda each: (each not in carried, each in tested))[:1]
    return {*sharing} | carried, {*registers} - {*sharing}


def _stays_a_branch(flow: ControlFlow, phi: Instruction, values: tuple[str, str]) -> bool:
    """Whether a narrow minimum or maximum stays a branch: one of two values, or of a value that a side computes as narrow.

    Not for a value that is loaded and stored with the same width: choosing it takes no conversion.
    """
    if _is_stored_alike(flow, phi, values):
        return False
    found = [flow.instruction(each) for each in values if each.startswith("%")]
    return len(found) == len(values) or any(
        each is not None and is_computed_narrow(flow, each, stored_bits(flow, phi)) for each in found
    )


def _is_stored_alike(flow: ControlFlow, phi: Instruction, values: tuple[str, str]) -> bool:
    """Whether one of the values is loaded with as many bits as are stored: the word made from it is in another register.

    Signs are ignored [ours]: a u16 that is stored as an i16 is converted, and stays a branch in GCC's code.
    """
    found = [flow.instruction(each) for each in values]
    bits = stored_bits(flow, phi)
    return any(each is not None and each.opcode == "load" and each.bits == bits for each in found)


def _is_narrow(flow: ControlFlow, phi: Instruction, values: tuple[str, str]) -> bool:
    """Whether the choice is between narrow values, and only stored: in `x if test else y`, C converts both sides before it chooses."""
    users = flow.users.get(phi.result or "", [])
    narrowed = len(users) == 1 and users[0].opcode == "trunc"
    if narrowed:
        users = flow.users.get(users[0].result or "", [])
    is_statement = any(label.startswith(("then", "else")) for label in arms_of(phi))
    return (
        len(users) == 1
        and users[0].opcode == "store"
        and users[0].bits < WORD
        and not (narrowed and is_statement and not _is_stored_alike(flow, phi, values))
    )


def _carried(flow: ControlFlow, phi: Instruction) -> list[str]:
    """Values that loops carry, and whose next value is the choice."""
    label, _ = flow.defined[phi.result or ""]
    headers = {loop.header for loop in flow.loops if label in loop.blocks}
    return [
        each.result or ""
        for each in flow.users.get(phi.result or "", [])
        if each.opcode == "phi" and flow.defined[each.result or ""][0] in headers
    ]


def _is_wanted_behind(flow: ControlFlow, value: str, phi: Instruction) -> bool:
    """Whether a value is used after the choice; then it cannot share the choice's register."""
    home, _ = flow.defined[phi.result or ""]
    places = _places(flow, value, phi)
    own, _ = flow.defined.get(value, ("", None))
    seen, waiting = {home}, [home]
    while waiting:
        label = waiting.pop()
        if label in places:
            return True
        for way in flow.blocks[label].successors:
            if way == home != own:
                return True  # by the choice itself, in the next iteration
            if way not in seen and way != own:
                seen.add(way)
                waiting.append(way)
    return False


def _places(flow: ControlFlow, value: str, phi: Instruction) -> set[str]:
    """Blocks in which a value is used; a phi uses it in the block from which it comes."""
    found = set[str]()
    for name in (value, *(each.result or "" for each in flow.users.get(value, []) if each.opcode in CASTS)):
        for user in flow.users.get(name, []):
            if user is phi or user.opcode in CASTS:
                continue
            if user.opcode == "phi":
                found |= {label for label, arm in arms_of(user).items() if arm == name}
            elif user.result in flow.defined:
                found.add(flow.defined[user.result][0])
            else:
                found |= {
                    label
                    for label, block in flow.blocks.items()
                    if any(each is user for each in block.instructions)
                }
    return found
