"""Optimised LLVM IR → Blackfin operations: a list of rules, one per kind of instruction.

Each rule says what a C compiler emits for an instruction in its surroundings. The rules are a first set;
how well they do is measured beside the machine code of GCC in `benchmarks/`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from bfsim.kernel.ir_text import Block, Instruction
from bfsim.kernel.isa import HARDWARE_LOOPS, ISSUE_CCLK, NOT_TAKEN_BP_CCLK, TAKEN_BP_CCLK, Op
from bfsim.kernel.loops import Flow, Loop, pointee_nbytes
from bfsim.kernel.profile import CompilerProfile

WIDTH = {"i8": (Op.LOAD8, Op.STORE8), "i16": (Op.LOAD16, Op.STORE16), "i32": (Op.LOAD32, Op.STORE32)}
WORD_MASKS = {"255", "65535"}
SHIFTS = ("shl", "lshr", "ashr")
FREE_ADDRESS_SCALES = (1, 2)  # P + (P << 1) and P + (P << 2): the two shift-adds of the address unit [PRM]


@dataclass(frozen=True, slots=True)
class Operation:
    """One Blackfin operation, or a library call: its class, source line and issue cycles."""

    op: Op
    line: int
    cclk: int


@dataclass(frozen=True, slots=True)
class Test:
    """Extra cycles each time `value` is true, or equals `equals`: the side of a branch that costs more or less."""

    value: str
    equals: int | None
    line: int
    extra_cclk: int


@dataclass(slots=True)
class Selection:
    """What was chosen for one block."""

    operations: list[Operation] = field(default_factory=list)
    tests: list[Test] = field(default_factory=list)

    def add(self, line: int, *ops: Op) -> None:
        """Append operations of one source line."""
        self.operations.extend(Operation(op, line, ISSUE_CCLK[op]) for op in ops)


@dataclass
class Selector:
    """Chooses the operations of one routine's blocks."""

    flow: Flow
    profile: CompilerProfile

    def block(self, block: Block) -> Selection:
        """Choose for every instruction of `block` but its terminator."""
        selection = Selection()
        loop = self.flow.innermost(block.label)
        self._branched_selects(block, selection)
        for instruction in block.instructions[:-1]:
            rule = RULES.get(instruction.opcode, _one_alu)
            selection.add(instruction.line, *rule(self, instruction, loop))
            if instruction.opcode in ("sdiv", "udiv", "srem", "urem"):
                selection.operations.append(Operation(Op.CALL, instruction.line, self.profile.divide_cclk))
        return selection

    def is_hardware_loop(self, loop: Loop) -> bool:
        """Counted, nested at most two deep from the inside, and without calls, which would need the loop registers."""
        if loop.height > HARDWARE_LOOPS or not self.flow.is_counted(loop):
            return False
        calls = (_is_call(each) for label in loop.blocks for each in self.flow.blocks[label].instructions)
        return not any(calls) and all(self.is_hardware_loop(inner) for inner in loop.inner)

    def is_exit_test(self, instruction: Instruction, loop: Loop | None) -> bool:
        """Whether a comparison only ends a hardware loop, so that the loop counter does its work."""
        if loop is None or not self.is_hardware_loop(loop):
            return False
        return instruction.result in self.flow.blocks[loop.latch].terminator.operands

    def only_addresses(self, value: str, loop: Loop, seen: frozenset[str] = frozenset()) -> bool:
        """Whether `value` serves only to walk pointers and count turns: post-increment does it for nothing."""
        if self.flow.slope(value, loop) is None:
            return False
        return all(
            user.result in seen
            or user.opcode == "getelementptr"
            or self.is_exit_test(user, loop)
            or (
                user.opcode in ("add", "sub", "shl", "mul", "phi", "or")
                and user.result is not None
                and self.only_addresses(user.result, loop, seen | {value})
            )
            for user in self.flow.users.get(value, [])
        )

    def walked_pointers(self, loop: Loop) -> int:
        """Arrays that `loop` walks with a stride other than the access size: one pointer add per turn each."""
        strides: dict[str, bool] = {}
        for label in loop.blocks:
            if self.flow.innermost(label) is not loop:
                continue
            for each in self.flow.blocks[label].instructions:
                if each.opcode in ("load", "store"):
                    slope = self.flow.slope(each.operands[-1], loop)
                    if slope:
                        root = self.root(each.operands[-1])
                        strides[root] = strides.get(root, False) or abs(slope) != _access_nbytes(each)
        return sum(strides.values())

    def root(self, pointer: str) -> str:
        """Array parameter (or other origin) that `pointer` points into."""
        seen = set()
        while pointer in self.flow.defined and pointer not in seen:
            seen.add(pointer)
            instruction = self.flow.defined[pointer][1]
            if instruction.opcode not in ("getelementptr", "phi", "select"):
                break
            candidates = [
                each for each in instruction.operands if each not in seen and each.startswith(("%", "@"))
            ]
            pointer = candidates[1 if instruction.opcode == "select" else 0] if candidates else pointer
        return pointer

    def _branched_selects(self, block: Block, selection: Selection) -> None:
        """Two or more selects on one condition were an `if` with a body: compilers branch over it, predicted taken."""
        for condition, group in self.select_groups(block).items():
            if len(group) < 2:
                continue
            # the arm that keeps an old value or a constant is the side that skips the body
            skips_when_true = group[0].operands[1] not in self.flow.defined or (
                self.flow.defined[group[0].operands[1]][1].opcode == "phi"
            )
            skip, body = TAKEN_BP_CCLK, NOT_TAKEN_BP_CCLK
            if_true, if_false = (skip, body) if skips_when_true else (body, skip)
            line = group[0].line
            selection.operations.append(Operation(Op.JUMP, line, if_false))
            selection.tests.append(Test(condition, None, line, if_true - if_false))

    def select_groups(self, block: Block) -> dict[str, list[Instruction]]:
        """Selects of 32-bit values in `block` by their condition."""
        groups: dict[str, list[Instruction]] = {}
        for each in block.instructions:
            if each.opcode == "select" and not each.text.split(",")[1].strip().startswith("i1"):
                groups.setdefault(each.operands[0], []).append(each)
        return groups


Rule = Callable[[Selector, Instruction, Loop | None], tuple[Op, ...]]


def _is_call(instruction: Instruction) -> bool:
    if instruction.opcode in ("sdiv", "udiv", "srem", "urem"):
        return True
    return instruction.opcode == "call" and "@llvm." not in instruction.text


def _access_nbytes(instruction: Instruction) -> int:
    return int(instruction.text.split()[1].rstrip(",")[1:]) // 8


def _nothing(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return ()


def _one_alu(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return (Op.ALU,)


def _load(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return (WIDTH[instruction.text.split()[1].rstrip(",")][0],)


def _store(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return (WIDTH[instruction.text.split()[1]][1],)


def _address(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    """Constant offsets and steps are part of the access; any other index is added in the address unit."""
    index = instruction.operands[-1]
    if not index.startswith("%") or (
        loop and selector.flow.slope(instruction.result or "", loop) is not None
    ):
        return ()
    scaled = Op.ALU if pointee_nbytes(instruction) == 1 else Op.ADD_SHIFT
    producer = selector.flow.defined.get(index)
    in_pointer_register = producer is None or (producer[1].opcode == "load" and "i32" in producer[1].text)
    return (scaled,) if in_pointer_register else (Op.MOVE, scaled)


def _add(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    if loop and selector.only_addresses(instruction.result or "", loop) and selector.is_hardware_loop(loop):
        return ()
    if _shift_added(selector, instruction):
        # the shift-add works on P registers: both values go there and the sum comes back
        return (Op.MOVE, Op.MOVE, Op.ADD_SHIFT, Op.MOVE)
    return (Op.ALU,)


def _shift_added(selector: Selector, instruction: Instruction) -> Instruction | None:
    """The shift by 1 or 2, used once, that an addition can take in."""
    for operand in instruction.operands:
        place = selector.flow.defined.get(operand)
        if place and place[1].opcode == "shl" and len(selector.flow.users[operand]) == 1:
            amount = place[1].operands[-1]
            if amount.isdigit() and int(amount) in FREE_ADDRESS_SCALES:
                return place[1]
    return None


def _shift(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    users = selector.flow.users.get(instruction.result or "", [])
    if len(users) == 1 and users[0].opcode == "add" and _shift_added(selector, users[0]) is instruction:
        return ()
    if loop and selector.only_addresses(instruction.result or "", loop):
        return ()
    return (Op.SHIFT,)


def _and(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    users = selector.flow.users.get(instruction.result or "", [])
    if instruction.operands[-1] == "31" and all(each.opcode in SHIFTS for each in users):
        return ()  # the language's shift mask; the shifter does it
    return (Op.EXTEND,) if instruction.operands[-1] in WORD_MASKS else (Op.ALU,)


def _multiply(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    if loop and selector.only_addresses(instruction.result or "", loop):
        return ()
    return (Op.MUL16,) if all(_is_16_bit(selector, each) for each in instruction.operands) else (Op.MUL32,)


def _is_16_bit(selector: Selector, operand: str) -> bool:
    """Whether the compiler sees that a factor fits in 16 bits: a constant, or an extended narrow value."""
    if operand.lstrip("-").isdigit():
        return -(1 << 15) <= int(operand) < 1 << 15
    place = selector.flow.defined.get(operand)
    return (
        place is not None
        and place[1].opcode in ("sext", "zext")
        and " i32 " not in place[1].text.split(" to ")[0]
    )


def _extend(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    if " i1 " in instruction.text:
        return (Op.MOVE,)  # CC to a register
    place = selector.flow.defined.get(instruction.operands[0])
    return () if place and place[1].opcode in ("load", "phi") else (Op.EXTEND,)


def _compare(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return () if selector.is_exit_test(instruction, loop) else (Op.COMPARE,)


def _select(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    if instruction.text.split(",")[1].strip().startswith("i1"):
        return (Op.MOVE, Op.ALU)  # `and` / `or` of two conditions goes through a register
    block = selector.flow.blocks[selector.flow.defined[instruction.result or ""][0]]
    branched = len(selector.select_groups(block)[instruction.operands[0]]) > 1
    return () if branched else (Op.COND_MOVE,)


def _call(selector: Selector, instruction: Instruction, loop: Loop | None) -> tuple[Op, ...]:
    return (Op.CALL,) if _is_call(instruction) else (Op.ALU,)


RULES: dict[str, Rule] = {
    "phi": _nothing,
    "freeze": _nothing,
    "trunc": _nothing,
    "sdiv": _nothing,
    "udiv": _nothing,
    "srem": _nothing,
    "urem": _nothing,
    "load": _load,
    "store": _store,
    "getelementptr": _address,
    "add": _add,
    "sub": _add,
    "shl": _shift,
    "lshr": _shift,
    "ashr": _shift,
    "and": _and,
    "mul": _multiply,
    "sext": _extend,
    "zext": _extend,
    "icmp": _compare,
    "select": _select,
    "call": _call,
}
