"""Numbers that are subtracted one by one: LLVM turns x - a - b into x - (a + b).

C compilers leave it as written. It matters if one of them is doubled: on the Blackfin, an addition of pointer registers
can include that, and a subtraction cannot.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.estimate.arithmetic.factored_sums import MADE_BY_LLVM
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, is_number


def with_subtractions(routine: Routine) -> Routine:
    """Return `routine` with each part of such a sum subtracted separately."""
    flow = ControlFlow(routine)
    return replace(routine, blocks=tuple(_separated(flow, block) for block in routine.blocks))


def _separated(flow: ControlFlow, block: BasicBlock) -> BasicBlock:
    rows: list[Instruction] = []
    for each in block.instructions:
        sums = list(_sums(flow, block, each.operands[1])) if each.opcode == "sub" else []
        made = {total.result for total in sums}
        parts = [part for total in sums for part in total.operands if part not in made]
        rows = [row for row in rows if row.result not in made]
        rows += _subtracted(each, parts) if parts else [each]
    return replace(block, instructions=tuple(rows))


def _sums(flow: ControlFlow, block: BasicBlock, name: str) -> Iterator[Instruction]:
    """Yield the sum of that name and its parts that are sums, as far as they are taken apart."""
    total = flow.instruction(name)
    if total is None or total.opcode != "add" or any(map(is_number, total.operands)):
        return
    if name.startswith(MADE_BY_LLVM) and len(flow.users[name]) == 1 and total in block.instructions:
        yield total
        for part in total.operands:
            yield from _sums(flow, block, part)


def _subtracted(each: Instruction, parts: list[str]) -> Iterator[Instruction]:
    left, right = each.operands
    kind = each.text.removesuffix(f" {left}, {right}")
    for number, part in enumerate(parts):
        is_last = number == len(parts) - 1
        result = each.result if is_last else f"{each.result}.less.{number}"
        yield replace(each, result=result, text=f"{kind} {left}, {part}", operands=(left, part))
        left = result or ""
