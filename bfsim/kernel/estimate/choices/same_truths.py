"""Choices between 1 and 0 that repeat a choice of truths: LLVM makes two choices of `on = a > t`, then `1 if on else 0`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import TRUTHS, BasicBlock, Instruction, Routine, arms_of, written


def with_same_truths(routine: Routine) -> Routine:
    """Return `routine` with such truths, as numbers, in place of the choices."""
    flow = ControlFlow(routine)
    return replace(routine, blocks=tuple(_without_copies(flow, block) for block in routine.blocks))


def _without_copies(flow: ControlFlow, block: BasicBlock) -> BasicBlock:
    phis = [each for each in block.instructions if each.opcode == "phi"]
    rest = block.instructions[len(phis) :]
    copies = [(each, truth) for each in phis if (truth := _truth(phis, each)) is not None]
    rows = tuple(
        written(
            each.result or "",
            f"zext i1 {truth.result} to {each.text.split()[1]}",
            (truth.result or "",),
            rest[0],
        )
        for each, truth in copies
    )
    gone = [each for each, _ in copies]
    return replace(block, instructions=(*(each for each in phis if each not in gone), *rows, *rest))


def _truth(phis: Sequence[Instruction], choice: Instruction) -> Instruction | None:
    """The choice of truths that agrees with a choice of numbers on every path."""
    arms = arms_of(choice)
    for each in phis:
        truths = arms_of(each) if each is not choice and each.text.startswith("phi i1 ") else {}
        if truths and all(str(TRUTHS.get(truth)) == arms[label] for label, truth in truths.items()):
            return each
    return None
