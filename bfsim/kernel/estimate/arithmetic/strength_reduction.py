"""Straight-line strength reduction: after y * w, (y + 1) * w is that plus w [gimple-ssa-strength-reduction.cc of GCC 12].

So the rows above and below cost an addition each, not a product. Products that a loop steps along are left alone.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine
from bfsim.kernel.ir.widths import WORD

DISTANCE = ".distance"


@dataclass(frozen=True, slots=True)
class _Product:
    """A product: the sum of terms and the constant `number`, times `stride`."""

    each: Instruction
    label: str
    terms: tuple[tuple[str, int], ...]
    number: int
    stride: str


def with_reduced_strength(routine: Routine) -> Routine:
    """Return `routine` with a sum in place of each product that differs from an earlier one by a few strides."""
    flow = ControlFlow(routine)
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    known: list[_Product] = []
    sums = dict[str, list[Instruction]]()
    for label in flow.order:
        for each in flow.blocks[label].instructions:
            products = list(_products(flow, evolution, label, each))
            found = next(
                (
                    (base, product)
                    for base in reversed(known)
                    for product in products
                    if base.label in flow.dominators[label] and _steps(base, product)
                ),
                None,
            )
            if found is not None:
                sums[each.result or ""] = list(_sum(*found))
            known += products
    if not sums:
        return routine
    blocks = (
        replace(
            block,
            instructions=tuple(
                row for each in block.instructions for row in sums.get(each.result or "", [each])
            ),
        )
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def _products(
    flow: ControlFlow, evolution: ScalarEvolution, label: str, each: Instruction
) -> Iterator[_Product]:
    """An instruction as a product, either factor as the stride; none if a loop steps it along."""
    if each.opcode != "mul" or each.bits != WORD or not all(name.startswith("%") for name in each.operands):
        return
    for loop in flow.loops_of(label):
        increment = evolution.increment(each.result or "", loop)
        if increment is not None and increment.moves:
            return
    for factor, stride in (each.operands, each.operands[::-1]):
        affine = evolution.affine(factor)
        yield _Product(each, label, affine.terms, affine.constant, stride)


def _steps(base: _Product, product: _Product) -> int:
    """How many strides a product is from another one, if that is a power of two or its negative; else 0."""
    apart = product.number - base.number
    alike = base.terms == product.terms and base.stride == product.stride
    return apart if alike and abs(apart).bit_count() == 1 else 0


def _sum(base: _Product, product: _Product) -> Iterator[Instruction]:
    apart, stride, each = _steps(base, product), product.stride, product.each
    shift = abs(apart).bit_length() - 1
    if shift:
        stride = f"{each.result}{DISTANCE}"
        operands = product.stride, str(shift)
        yield replace(
            each, result=stride, opcode="shl", text=f"shl i32 {', '.join(operands)}", operands=operands
        )
    opcode = "add" if apart > 0 else "sub"
    operands = base.each.result or "", stride
    yield replace(each, opcode=opcode, text=f"{opcode} i32 {', '.join(operands)}", operands=operands)
