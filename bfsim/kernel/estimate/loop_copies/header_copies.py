"""Loop headers of two tests: `while a and b` is rotated so that both are made once before the loop, and then at its end [tree-ssa-loop-ch.cc of GCC 12].

LLVM copies only the first test. GCC goes on while the next one also leaves the loop and is computed from values that
the loop carries and that do not change in it: from counters, or from sums if that is enough for a `break`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from bfsim.kernel.estimate.arithmetic.bits_set import STATEMENTS as WORD_COUNT
from bfsim.kernel.estimate.arithmetic.bits_set import counted_word
from bfsim.kernel.estimate.conditions.short_circuits import SECOND
from bfsim.kernel.estimate.inlining.statements import TEST_SIZE, statement_size
from bfsim.kernel.estimate.jump_threading.flags import JumpThreading
from bfsim.kernel.estimate.loop_copies.values_behind import with_values_chosen_behind
from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.ir.control_flow import COPIED, ControlFlow, Loop
from bfsim.kernel.ir.edges import going_to
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    each_arm,
    is_number,
    phi_of,
    predicate,
    renamed,
    type_of,
    with_each_arm,
)

WHILE = re.compile(r"test(\.|$)")
"""The block of the test of a `while`."""
MOST_STATEMENTS = 20  # [param_max_loop_header_insns] of both tests
AGAIN, LEFT = ".turned", ".left"  # ends the names of the header's values where both copies of it lead


def copy_headers(routine: Routine) -> Routine:
    """Return `routine` with each loop rotated once more if its header is such a test, without an access."""
    return _copied(routine, lambda flow, loop: not _accesses(flow, loop))


def copy_breaks(routine: Routine) -> Routine:
    """Return `routine` with each loop rotated once more if it begins with accesses and such a test, of a `break`."""
    return _copied(routine, lambda flow, loop: _accesses(flow, loop) and _breaks(flow, loop))


def _copied(routine: Routine, wanted: Callable[[ControlFlow, Loop], bool]) -> Routine:
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        flow = ControlFlow(routine)
        loop = next((each for each in flow.loops if each.header == header), None)
        if loop is None or not wanted(flow, loop):
            continue
        flow = ControlFlow(with_values_chosen_behind(flow, loop))
        if _is_copied(flow, loop):
            routine = _Rotation(flow, loop).routine()
    return routine


def _accesses(flow: ControlFlow, loop: Loop) -> bool:
    return any(each.opcode in ("load", "store") for each in flow.blocks[loop.header].instructions)


def _breaks(flow: ControlFlow, loop: Loop) -> bool:
    """Whether the header's test is not the one that the loop begins with in the source: that was copied, and is at its end."""
    return flow.blocks[loop.header].terminator.line != flow.blocks[loop.latch].terminator.line


def _is_copied(flow: ControlFlow, loop: Loop) -> bool:
    header = flow.blocks[loop.header]
    inside = [way for way in header.successors if way in loop.blocks]
    ends_below = set(flow.blocks[loop.latch].successors) - loop.blocks and loop.latch != loop.header
    if (
        header.terminator.opcode != "br"
        or len(inside) != 1
        or len(set(header.successors)) != 2
        or not ends_below
    ):
        return False
    if loop.latch.endswith(SECOND):
        return False  # LLVM had joined both tests, so they are at its end
    if WHILE.match(loop.header) or (inside == [loop.latch] and _is_while_alone(flow.blocks[loop.latch])):
        return False  # it ended with its `break`: it is a do-while loop already [do_while_loop_p]
    way_out = next(way for way in header.successors if way not in loop.blocks)
    back = [each for each in flow.predecessors[loop.header] if each in loop.blocks]
    is_entered_once = len(flow.predecessors[loop.header]) == len(back) + 1
    alone = flow.predecessors[inside[0]] == [loop.header] and back == [loop.latch] and not flow.is_split(loop)
    if (
        not (alone and is_entered_once)
        or _size(flow, header) > MOST_STATEMENTS
        or _has_phi(flow.blocks[inside[0]])
    ):
        return False
    return _counts(flow, loop) and _uses_are_near(flow, header, inside[0], way_out)


def _is_while_alone(block: BasicBlock) -> bool:
    """Whether a block is the test of a `while`, and nothing is stepped in it."""
    steps = (each for each in block.instructions if each.opcode not in ("phi", "icmp", "br"))
    return WHILE.match(block.label) is not None and not any(steps)


def _size(flow: ControlFlow, header: BasicBlock) -> int:
    """The statements of both tests: the comparison of the first, and all of the second, in which a count of bits is one."""
    statements = sum(statement_size(flow, each) for each in header.instructions if not each.is_call)
    counts = sum(counted_word(flow, each) is not None for each in header.instructions)
    sums = sum(_adds_to_index(flow, each) for each in header.instructions)
    return TEST_SIZE + statements - counts * (WORD_COUNT - 1) - sums


def _adds_to_index(flow: ControlFlow, each: Instruction) -> bool:
    """Whether an address is only the base of another one: GCC adds the indices, and scales their sum."""
    users = flow.users.get(each.result or "", [])
    return (
        each.opcode == "getelementptr"
        and statement_size(flow, each) > 1
        and [user.opcode for user in users] == ["getelementptr"]
    )


def _has_phi(block: BasicBlock) -> bool:
    return any(each.opcode == "phi" for each in block.instructions)


def _counts(flow: ControlFlow, loop: Loop) -> bool:
    """Whether neither side of the header's test is loaded, or computed from a load, without a value that the loop carries."""
    header = flow.blocks[loop.header]
    test = flow.instruction(header.terminator.operands[0])
    if test is None or test.opcode != "icmp" or flow.is_overflow_guard(header):
        return False
    if any(each.is_call for each in header.instructions):
        return False
    if JumpThreading(flow).decides(header.terminator):
        return False  # gone by then
    return all(_is_same(flow, loop, each) or _is_carried(flow, loop, each) for each in test.operands[:2])


def _is_same(flow: ControlFlow, loop: Loop, value: str) -> bool:
    each = flow.instruction(value)
    return flow.is_invariant(value, loop) or (each is not None and is_same(flow, loop, each))


def _is_carried(flow: ControlFlow, loop: Loop, value: str) -> bool:
    """Whether a value of the header is one of its phis, or computed from one, and not loaded."""
    each = flow.instruction(value)
    if each is None or flow.defined[value][0] != loop.header or each.opcode == "load":
        return False
    return each.opcode == "phi" or any(_is_carried(flow, loop, operand) for operand in each.operands)


def _uses_are_near(flow: ControlFlow, header: BasicBlock, inside: str, way_out: str) -> bool:
    """Whether the header's values are only used where just one of its sides leads, or in a phi where the sides join."""
    own = {each.result for each in header.instructions if each.result}
    for block in flow.routine.blocks:
        behind = flow.dominators[block.label]
        for each in block.instructions:
            if block.label == header.label or each.opcode == "phi" or not own & set(each.operands):
                continue
            if inside not in behind and (
                way_out not in behind or flow.predecessors[way_out] != [header.label]
            ):
                return False
        for each in block.instructions if block.label != header.label else ():
            for value, source in each_arm(each) if each.opcode == "phi" else ():
                before = flow.dominators[source]
                near = source == header.label or inside in before
                if value in own and not near:
                    return False
    return True


class _Rotation:
    """One loop, whose header becomes its latch; a copy of it stands before the loop."""

    def __init__(self, flow: ControlFlow, loop: Loop) -> None:
        self.flow, self.loop = flow, loop
        self.header = flow.blocks[loop.header]
        self.entering = flow.entering(loop)
        self.copy = f"{loop.header}{COPIED}"
        self.inside = next(way for way in self.header.successors if way in loop.blocks)
        self.way_out = next(way for way in self.header.successors if way not in loop.blocks)
        phis = [each for each in self.header.instructions if each.opcode == "phi"]
        arms = {each.result or "": arms_of(each) for each in phis}
        self.first = {name: values[self.entering] for name, values in arms.items()}
        own = {each.result for each in self.header.instructions}
        carried = {name: values[loop.latch] for name, values in arms.items()}
        self.last = {name: f"{value}{AGAIN}" if value in own else value for name, value in carried.items()}
        self.carried = {value for value in carried.values() if value in own}
        """Values of the header that its next run uses."""
        self.rows = [each for each in self.header.instructions if each.opcode != "phi"]
        for each in self.rows:
            if each.result:
                self.first[each.result] = f"{each.result}{COPIED}"
                self.last[each.result] = each.result
        test = self.flow.instruction(self.header.terminator.operands[0])
        assert test is not None
        first = [self.first.get(each, each) for each in test.operands[:2]]
        self.is_sure = _holds(predicate(test), first) is (self.header.successors[0] == self.inside)
        """Whether constants say that the first test does not leave the loop."""
        self.types = {each.result: type_of(each) for each in self.header.instructions if each.result}

    def routine(self) -> Routine:
        blocks = []
        for block in self.flow.routine.blocks:
            if block.label == self.header.label:
                blocks.append(self._made(self.copy, self.first, own=True))
                blocks.append(self._made(block.label, self.last, own=False))
            elif block.label == self.entering:
                blocks.append(going_to(self._behind(block), self.header.label, self.copy))
            else:
                blocks.append(self._behind(block))
        return replace(self.flow.routine, blocks=tuple(blocks))

    def _made(self, label: str, values: dict[str, str], *, own: bool) -> BasicBlock:
        """The header, as it stands before the loop or at its end."""
        rows = []
        for each in self.rows:
            known = {name: value for name, value in values.items() if name != each.result}
            row = renamed(each, known)
            rows.append(replace(row, result=values[each.result]) if own and each.result else row)
        if own and self.is_sure:
            rows[-1] = replace(rows[-1], text=f"br label %{self.inside}", operands=(), weights=(), hint="")
        return BasicBlock(label, tuple(rows), () if own else self.header.enters)

    def _behind(self, block: BasicBlock) -> BasicBlock:
        """A block with the header's values as they are there: phis where both copies of the header lead."""
        above = self.flow.dominators[block.label]
        if self.inside in above:
            names = {name: f"{name}{AGAIN}" for name in self.types}
        elif self.way_out in above and self.flow.predecessors[self.way_out] == [self.header.label]:
            names = {name: f"{name}{LEFT}" for name in self.types}
        else:
            names = {}
        rows = [
            self._phi(each, names, block.label) if each.opcode == "phi" else renamed(each, names)
            for each in block.instructions
        ]
        if names and block.label in (self.inside, self.way_out):
            chosen = [
                self._choice(name, names[name], block.label)
                for name in self.types
                if self._is_used(name, block.label)
            ]
            rows = [*chosen, *rows]
        return replace(block, instructions=tuple(rows))

    def _is_used(self, name: str, side: str) -> bool:
        """Whether a value of the header is used after one of its sides."""
        if side == self.inside and name in self.carried:
            return True
        for label, block in self.flow.blocks.items():
            for each in block.instructions if label != self.header.label else ():
                if each.opcode == "phi":
                    sources = [source for value, source in each_arm(each) if value == name]
                else:
                    sources = [label] if name in each.operands else []
                if any(side in self.flow.dominators[source] for source in sources):
                    return True
        return False

    def _comes_from_copy(self, side: str) -> bool:
        return side == self.inside or not self.is_sure

    def _choice(self, name: str, chosen: str, side: str) -> Instruction:
        arms = [(self.first[name], self.copy)] if self._comes_from_copy(side) else []
        arms.append((self.last[name], self.header.label))
        return phi_of(chosen, self.types[name], arms, replace(self.header.terminator, location=""))

    def _phi(self, phi: Instruction, names: dict[str, str], side: str) -> Instruction:
        arms = []
        for value, source in each_arm(phi):
            if source == self.header.label:
                if self._comes_from_copy(side):
                    arms.append((self.first.get(value, value), self.copy))
                arms.append((self.last.get(value, value), self.header.label))
            elif self.inside in self.flow.dominators[source]:
                arms.append((f"{value}{AGAIN}" if value in self.types else value, source))
            else:
                arms.append((names.get(value, value), source))
        return with_each_arm(phi, arms)


def _holds(relation: str, values: list[str]) -> bool | None:
    """Whether the relation holds between two constants; None if a value is not constant."""
    if not all(map(is_number, values)):
        return None
    left, right = (int(each) % (1 << 32) if relation[0] == "u" else int(each) for each in values)
    return {
        "eq": left == right,
        "ne": left != right,
        "lt": left < right,
        "le": left <= right,
        "gt": left > right,
        "ge": left >= right,
    }[relation[-2:]]
