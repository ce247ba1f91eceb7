"""The control flow of a routine: its blocks, dominators and loops, and where values are defined and used."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from functools import cached_property

from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine

NEAR_OVERFLOW = (1 << 31) - (1 << 16)
"""A comparison with a number this large tests whether an i32 is about to wrap."""
COPIED = ".copied"
"""Suffix of the names of copies of a loop's header that stand in front of the loop: a label, and values."""
BACK = ".back"
"""Suffix of the label of an empty block that joins ways back to a loop's header; in the code, each goes back itself."""
BEFORE_TESTS = ".hoisted"
"""Suffix of the names of values that are computed or loaded before a test, because both of its sides do so."""
EITHER = ".either"
"""Suffix of the names of chosen addresses, of which each side computes its own."""
OUTER = ".outer"
"""Suffix of the label that LLVM gives the outer of two loops that it has made of one."""


@dataclass(slots=True)
class Loop:
    """A natural loop. `inner` are the loops directly inside it, `leaving` blocks that a threaded jump takes out of it.

    `counting`: the block whose test counts the iterations, if one does.
    """

    header: str
    latch: str
    blocks: frozenset[str]
    inner: list[Loop] = field(default_factory=list)
    leaving: frozenset[str] = frozenset()
    counting: str = ""

    @property
    def height(self) -> int:
        """1 for an innermost loop, one more for every level inside."""
        return 1 + max((each.height for each in self.inner), default=0)


@dataclass
class ControlFlow:
    """Control flow of one routine. `joins_split`: whether two loops that LLVM has made of one count as one (`is_split`)."""

    routine: Routine
    joins_split: bool = True

    @cached_property
    def blocks(self) -> dict[str, BasicBlock]:
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
        """For each block, the blocks that every path to it passes."""
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
    def post_dominators(self) -> dict[str, frozenset[str]]:
        """For each block, the blocks that every path from it passes."""
        every = frozenset(self.blocks)
        found = {
            label: every if self.blocks[label].successors else frozenset({label}) for label in self.blocks
        }
        changed = True
        while changed:
            changed = False
            for label in reversed(self.order):
                behind = [found[each] for each in self.blocks[label].successors]
                if behind:
                    new = frozenset.intersection(*behind) | {label}
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
        return self.blocks_before([latch] if latch != header else [], {header, latch})

    def blocks_before(
        self, first: Iterable[str], found: Collection[str], inside: Collection[str] | None = None
    ) -> set[str]:
        """Return `found` and the blocks (`inside`) from which a path leads to the first ones without passing `found`."""
        before, waiting = set(found), [*first]
        while waiting:
            for each in self.predecessors[waiting.pop()]:
                if each not in before and (inside is None or each in inside):
                    before.add(each)
                    waiting.append(each)
        return before

    def innermost(self, label: str) -> Loop | None:
        """Return the smallest loop around a block."""
        return next((loop for loop in self.loops if label in loop.blocks), None)

    def is_invariant(self, value: str, loop: Loop) -> bool:
        """Whether `value` stays the same while `loop` iterates."""
        return value not in self.defined or self.defined[value][0] not in loop.blocks

    def instruction(self, value: str) -> Instruction | None:
        """Return the instruction that computes `value`; None for parameters and constants."""
        place = self.defined.get(value)
        return place[1] if place else None

    @cached_property
    def order(self) -> tuple[str, ...]:
        """Labels in reverse post-order: a block before those it leads to, except by back edges."""
        found: list[str] = []
        entry = self.routine.blocks[0].label
        seen, open_visits = {entry}, [(entry, iter(reversed(self.blocks[entry].successors)))]
        while open_visits:
            label, successors = open_visits[-1]
            following = next((each for each in successors if each not in seen), None)
            if following is None:
                found.append(label)
                open_visits.pop()
            else:
                seen.add(following)
                open_visits.append((following, iter(reversed(self.blocks[following].successors))))
        return tuple(reversed(found))

    def tested(self, label: str) -> str:
        """Return the block with the test that an empty block is one side of; for any other block, that block itself."""
        block, before = self.blocks[label], self.predecessors[label]
        is_empty = len(block.instructions) == 1 and len(set(block.successors)) == 1 and len(before) == 1
        return before[0] if is_empty else label

    def is_overflow_guard(self, block: BasicBlock) -> bool:
        """Whether a block only tests if a sum would wrap: there is no such test in C, where signed sums may not wrap."""
        operands = block.terminator.operands
        test = self.instruction(operands[0]) if block.terminator.opcode == "br" and operands else None
        if test is None or test.opcode != "icmp" or not {"eq", "ne"} & set(test.text.split()[:3]):
            return False
        bound = test.operands[1].lstrip("-")
        return bound.isdigit() and int(bound) >= NEAR_OVERFLOW

    def around(self, loop: Loop) -> Loop | None:
        """Return the loop directly around `loop`."""
        return next((each for each in self.loops if loop in each.inner), None)

    def is_split(self, loop: Loop) -> bool:
        """Whether this is the inner of two loops that LLVM has made of one with a `continue`; its test is at the top."""
        return self.joins_split and f"{loop.header}{OUTER}" in self.blocks

    def ending(self, loop: Loop) -> str:
        """Return the block whose test ends `loop`."""
        if loop.counting:
            return loop.counting
        return loop.header if self.is_split(loop) else loop.latch

    def loops_of(self, label: str) -> list[Loop]:
        """Return the loops around a block, the innermost first."""
        return [loop for loop in self.loops if label in loop.blocks]

    def entering(self, loop: Loop) -> str:
        """Return the block from which `loop` is entered."""
        return next(each for each in self.predecessors[loop.header] if each not in loop.blocks)

    def inside(self, loop: Loop) -> list[str]:
        """Return the labels of the blocks of `loop`, in order: no decision may depend on the order of a set."""
        return [label for label in self.order if label in loop.blocks]

    def exits(self, loop: Loop) -> list[str]:
        """Return the blocks of `loop` that can leave it."""
        return [label for label in self.inside(loop) if set(self.blocks[label].successors) - loop.blocks]

    def root(self, pointer: str) -> str:
        """Return the array parameter (or other origin) that `pointer` points into."""
        seen: set[str] = set()
        while pointer in self.defined and pointer not in seen:
            seen.add(pointer)
            instruction = self.defined[pointer][1]
            if instruction.opcode not in ("getelementptr", "phi", "select"):
                break
            names = [
                each for each in instruction.operands if each not in seen and each.startswith(("%", "@"))
            ]
            pointer = names[1 if instruction.opcode == "select" else 0] if names else pointer
        return pointer

    def always_run(self, loop: Loop) -> frozenset[str]:
        """Return the blocks that run whenever `loop` is entered: no path leaves it before them.

        [last_always_executed_block in tree-predcom.cc of GCC 12]
        """
        return frozenset.intersection(*(self.dominators[each] for each in (loop.latch, *self.exits(loop))))

    def runs_before(self, one: Instruction, label: str, other: Instruction) -> bool:
        """Whether an instruction has been run whenever another one, of the block `label`, is."""
        home, _ = self.defined[one.result or ""]
        if home != label:
            return home in self.dominators[label]
        rows = self.blocks[label].instructions
        return rows.index(one) < rows.index(other)

    def every_iteration(self, label: str, loop: Loop) -> bool:
        """Whether a block runs once in each iteration of `loop`."""
        return label in self.dominators[loop.latch] and self.innermost(label) is loop


def pointee_nbytes(instruction: Instruction) -> int:
    """Return the bytes by which an index of 1 moves a `getelementptr`; 1 for anything else."""
    if instruction.opcode != "getelementptr":
        return 1
    # for an array type, that of its element: the last index counts
    element = re.search(r"i(\d+)\]*,", instruction.text)
    return int(element.group(1)) // 8 if element else 1
