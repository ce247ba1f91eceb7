"""Loops of an optimised routine: which there are, which count, and which values walk along with them.

A compiler for the Blackfin turns a counted loop into a hardware loop and an address that moves by a
constant per turn into a post-incremented pointer; this file finds both.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property

from bfsim.kernel.ir_text import PHI_ARM, Block, Instruction, Routine


@dataclass(slots=True)
class Loop:
    """A natural loop. `inner` are the loops directly inside it."""

    header: str
    latch: str
    blocks: frozenset[str]
    inner: list[Loop] = field(default_factory=list)

    @property
    def height(self) -> int:
        """1 for an innermost loop, one more for every level inside."""
        return 1 + max((each.height for each in self.inner), default=0)


@dataclass
class Flow:
    """Control flow of one routine."""

    routine: Routine

    @cached_property
    def blocks(self) -> dict[str, Block]:
        """Blocks by label."""
        return {each.label: each for each in self.routine.blocks}

    @cached_property
    def defined(self) -> dict[str, tuple[str, Instruction]]:
        """Where each name is defined: (block label, instruction)."""
        return {
            each.result: (block.label, each)
            for block in self.routine.blocks
            for each in block.instructions
            if each.result
        }

    @cached_property
    def users(self) -> dict[str, list[Instruction]]:
        """Instructions that use each name."""
        found: dict[str, list[Instruction]] = {}
        for block in self.routine.blocks:
            for each in block.instructions:
                for operand in set(each.operands):
                    found.setdefault(operand, []).append(each)
        return found

    @cached_property
    def predecessors(self) -> dict[str, list[str]]:
        """Labels of the blocks that go to each block."""
        found: dict[str, list[str]] = {each: [] for each in self.blocks}
        for block in self.routine.blocks:
            for successor in dict.fromkeys(block.successors):
                found[successor].append(block.label)
        return found

    @cached_property
    def dominators(self) -> dict[str, frozenset[str]]:
        """Of each block: the blocks that every way to it passes."""
        every = frozenset(self.blocks)
        entry = self.routine.blocks[0].label
        found = dict.fromkeys(self.blocks, every) | {entry: frozenset({entry})}
        changed = True
        while changed:
            changed = False
            for label in self.blocks:
                if label == entry:
                    continue
                before = [found[each] for each in self.predecessors[label]]
                new = frozenset.intersection(*before) | {label} if before else frozenset({label})
                changed |= new != found[label]
                found[label] = new
        return found

    @cached_property
    def loops(self) -> tuple[Loop, ...]:
        """Every loop, inner ones before those around them; back edges to one header are one loop."""
        bodies: dict[str, set[str]] = {}
        latches: dict[str, str] = {}
        for label, block in self.blocks.items():
            for header in block.successors:
                if header in self.dominators[label]:
                    latches[header] = label
                    bodies.setdefault(header, {header}).update(self._body(header, label))
        found = [Loop(header, latches[header], frozenset(body)) for header, body in bodies.items()]
        found.sort(key=lambda loop: (len(loop.blocks), loop.header))
        for index, loop in enumerate(found):
            around = next((each for each in found[index + 1 :] if loop.header in each.blocks), None)
            if around:
                around.inner.append(loop)
        return tuple(found)

    def _body(self, header: str, latch: str) -> set[str]:
        body, waiting = {header}, [latch]
        while waiting:
            label = waiting.pop()
            if label not in body:
                body.add(label)
                waiting.extend(self.predecessors[label])
        return body

    def innermost(self, label: str) -> Loop | None:
        """Smallest loop around a block."""
        return next((loop for loop in self.loops if label in loop.blocks), None)

    def is_invariant(self, value: str, loop: Loop) -> bool:
        """Whether `value` stays the same while `loop` turns."""
        return value not in self.defined or self.defined[value][0] not in loop.blocks

    def step(self, value: str, loop: Loop) -> int | None:
        """Constant by which `value`, a phi of the loop's header, moves per turn; None if it does not."""
        place = self.defined.get(value)
        if place is None or place[0] != loop.header or place[1].opcode != "phi":
            return None
        arms = PHI_ARM.findall(place[1].text)
        moving = [arm for arm, source in arms if source[1:] in loop.blocks]
        update = self.defined.get(moving[0]) if len(moving) == 1 else None
        if (
            update is None
            or update[1].opcode not in ("add", "getelementptr")
            or update[1].operands[0] != value
        ):
            return None
        constant = update[1].operands[-1]
        return int(constant) * pointee_nbytes(update[1]) if constant.lstrip("-").isdigit() else None

    def is_counted(self, loop: Loop) -> bool:
        """Whether the number of turns is known when the loop starts: its only exit compares a stepping value."""
        around = loop.blocks | {
            label for label, block in self.blocks.items() if block.terminator.opcode == "unreachable"
        }
        exits = [label for label in loop.blocks if set(self.blocks[label].successors) - around]
        if exits != [loop.latch]:
            return False
        condition = self.defined.get(next(iter(self.blocks[loop.latch].terminator.operands), ""))
        if condition is None or condition[1].opcode != "icmp":
            return False
        left, right = condition[1].operands[:2]
        return any(
            self.slope(moving, loop) and self.is_invariant(fixed, loop)
            for moving, fixed in ((left, right), (right, left))
        )

    def slope(self, value: str, loop: Loop, depth: int = 8) -> int | None:
        """Bytes (or units) by which `value` moves per turn of `loop`: 0 when invariant, None when not constant."""
        if self.is_invariant(value, loop):
            return 0
        step = self.step(value, loop)
        if step is not None:
            return step
        instruction = self.defined[value][1]
        parts = [self.slope(each, loop, depth - 1) if depth else None for each in instruction.operands]
        if None in parts:
            return None
        return _combined(instruction, [part for part in parts if part is not None])


def _combined(instruction: Instruction, parts: list[int]) -> int | None:
    """Slope of an instruction from those of its operands."""
    last = instruction.operands[-1] if instruction.operands else ""
    match instruction.opcode:
        case "getelementptr":
            return parts[0] + parts[-1] * pointee_nbytes(instruction)
        case "add":
            return sum(parts)
        case "or" if " disjoint " in instruction.text:
            return sum(parts)
        case "sub":
            return parts[0] - parts[1]
        case "mul" if last.lstrip("-").isdigit():
            return parts[0] * int(last)
        case "shl" if last.isdigit():
            return parts[0] << int(last)
        case "sext" | "zext" | "trunc":
            return parts[0]
    return None


def pointee_nbytes(instruction: Instruction) -> int:
    """Bytes that an index of 1 moves a `getelementptr`; 1 for anything else."""
    if instruction.opcode != "getelementptr":
        return 1
    element = re.search(
        r"i(\d+)\]*,", instruction.text
    )  # of an array type, its element: the last index counts
    return int(element.group(1)) // 8 if element else 1
