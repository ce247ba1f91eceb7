"""Sums with a constant, added before they are multiplied: LLVM turns (x - 128) * 454 into x * 454 - 58112.

C compilers leave it as it is written [fitted: GCC 12.2 adds, and multiplies words, in `split_uyvy` and `yuv_to_rgb`]. So the factor
is a word, not the byte that `x` was.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, is_number
from bfsim.kernel.ir.widths import WORD

MADE_BY_LLVM = "%.n"  # begin the names of values that the kernel had none for (`ir_text.with_names`)
SUM = ".sum"


def factor_sums(routine: Routine) -> Routine:
    """Return `routine` with each such sum computed before its product."""
    flow = ControlFlow(routine)
    return replace(routine, blocks=tuple(_factored(flow, block) for block in routine.blocks))


def _factored(flow: ControlFlow, block: BasicBlock) -> BasicBlock:
    rows = list(block.instructions)
    for product in block.instructions:
        total = _added_to(flow, product)
        if total is not None and any(total is row for row in rows):
            place = next(number for number, row in enumerate(rows) if row is total)
            rows[place : place + 1] = _rows(flow, product, total)
            rows = [row for row in rows if row is not product]
    return replace(block, instructions=tuple(rows))


def _added_to(flow: ControlFlow, product: Instruction) -> Instruction | None:
    """The sum with a constant that is the only use of a product by a constant that LLVM has made."""
    name = product.result or ""
    if product.opcode != "mul" or not name.startswith(MADE_BY_LLVM) or product.bits != WORD:
        return None
    users = flow.users[name]
    if len(users) != 1 or users[0].opcode != "add" or not (_is_number(product) and _is_number(users[0])):
        return None
    return users[0]


def _is_number(each: Instruction) -> bool:
    return is_number(each.operands[1])


def _rows(flow: ControlFlow, product: Instruction, total: Instruction) -> list[Instruction]:
    """The sum, its product, and what is left to add."""
    factor, name = int(product.operands[1]), product.result or ""
    before, rest = _parts(int(total.operands[1]), factor, _wanted_bits(flow, total))
    inner = f"{name}{SUM}"
    result = name if rest else total.result
    rows = [
        _arithmetic("add", product, inner, product.operands[0], before),
        _arithmetic("mul", product, result, inner, factor),
    ]
    return [*rows, _arithmetic("add", total, total.result, name, rest)] if rest else rows


def _arithmetic(opcode: str, like: Instruction, result: str | None, left: str, right: int) -> Instruction:
    text = f"{opcode} i{WORD} {left}, {right}"
    return replace(like, opcode=opcode, result=result, text=text, operands=(left, str(right)))


def _parts(added: int, factor: int, bits: int) -> tuple[int, int]:
    """What is added before and after the multiplication: as little as possible, in the bits that are wanted."""
    found = []
    for width in (WORD, bits):
        wrapped = (added + (1 << (width - 1))) % (1 << width) - (1 << (width - 1))
        before = (2 * wrapped + abs(factor)) // (2 * abs(factor)) * (1 if factor > 0 else -1)
        found.append((before, wrapped - before * factor))
    return min(found, key=lambda parts: (abs(parts[1]), abs(parts[0])))


def _wanted_bits(flow: ControlFlow, total: Instruction) -> int:
    """How many low bits of a sum are wanted: those that a shift and a narrowing cut out of it."""
    wanted = 0
    for shift in flow.users[total.result or ""]:
        cuts = flow.users.get(shift.result or "", [])
        if shift.opcode != "lshr" or not _is_number(shift) or not cuts:
            return WORD
        for cut in cuts:
            if not cut.text.startswith(f"trunc i{WORD} "):
                return WORD
            wanted = max(wanted, int(shift.operands[1]) + int(cut.text.rsplit("i", 1)[1]))
    return min(wanted or WORD, WORD)
