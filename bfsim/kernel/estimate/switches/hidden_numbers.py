"""Numbers hidden from LLVM: it would leave out tests that can no longer hold, although GCC has already made a table of them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import HIDES, NAME, BasicBlock, Instruction, arms_of, renamed, with_values

DECLARED = f"declare i32 @{HIDES}(i32) nounwind willreturn memory(none)"
HIDDEN = re.compile(rf"^  (%[\w.$-]+) = .*@{re.escape(HIDES)}\(i32 (\S+?)\)", re.MULTILINE)
FUNCTIONS = re.compile(r"^(?=define )", re.MULTILINE)  # each has its own names


def hide(flow: ControlFlow, blocks: dict[str, BasicBlock], value: str, test: str) -> None:
    """Let instructions take a word unknown to LLVM in place of `value`, if they do not already.

    All instructions with this operand do; if it is a phi, which a loop may carry, only those in block `test` and the
    blocks that it dominates.
    """
    if not any(_asks(row, value) for row in blocks[test].instructions):
        return
    hidden, first = f"{value}.hidden.{test}", test
    each = flow.instruction(value)
    if each is None or each.opcode != "phi":
        asking = [
            label
            for label, block in flow.blocks.items()
            if any(_asks(row, value) for row in block.instructions)
        ]
        common = frozenset.intersection(*(flow.dominators[label] for label in asking))
        first = max(common, key=lambda label: len(flow.dominators[label]))
    for label, block in blocks.items():
        blocks[label] = replace(block, instructions=tuple(_asking(flow, block, first, value, hidden)))


def _asking(
    flow: ControlFlow, block: BasicBlock, first: str, value: str, hidden: str
) -> Iterator[Instruction]:
    """Return the instructions of a block that ask for a hidden number if the block `first`, which hides it, comes before."""
    is_there = first in flow.dominators[block.label] and block.label != first
    for each in block.instructions:
        if each.opcode == "phi":
            arms = {
                label: hidden if arm == value and first in flow.dominators[label] else arm
                for label, arm in arms_of(each).items()
            }
            yield with_values(each, arms)
            continue
        if block.label == first and not is_there and (_asks(each, value) or each is block.terminator):
            text = f"call i32 @{HIDES}(i32 {value})"
            yield Instruction(hidden, "call", text, (value,), each.line, location=each.location)
            is_there = True
        yield renamed(each, {value: hidden}) if is_there else each


def _asks(each: Instruction, value: str) -> bool:
    return value in each.operands and each.opcode != "phi"


def revealed(text: str) -> str:
    """Return a module with the hidden numbers back in place."""
    return "".join(_revealed(part) for part in FUNCTIONS.split(text))


def _revealed(text: str) -> str:
    hidden = dict(HIDDEN.findall(text))
    while again := {name: hidden[value] for name, value in hidden.items() if value in hidden}:
        hidden |= again
    rows = (row for row in text.splitlines(keepends=True) if HIDES not in row)
    return NAME.sub(lambda found: hidden.get(found[0], found[0]), "".join(rows))
