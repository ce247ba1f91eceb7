"""Common factors in a sum of products: a + 4 * b + 6 * c + 4 * d multiplies b + d by 4 once [undistribute_ops_list in tree-ssa-reassoc.cc of GCC 12].

GCC does so if the sum may wrap, as one that is stored as a byte or a half-word may; it leaves sums of i32 as written.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, is_number, written
from bfsim.kernel.ir.widths import WORD

COMMON = ".common"


def with_common_factors(routine: Routine) -> Routine:
    """Return `routine` with each such sum rewritten."""
    flow = ControlFlow(routine)
    return replace(routine, blocks=tuple(_Block(flow, block).factored() for block in routine.blocks))


@dataclass(frozen=True)
class _Block:
    flow: ControlFlow
    block: BasicBlock

    def factored(self) -> BasicBlock:
        rows = list(self.block.instructions)
        for total in self.block.instructions:
            if total.opcode != "add" or total.bits >= WORD or not self._is_stored(total):
                continue
            terms, gone = self._terms(total)
            by_factor = self._by_factor(terms)
            if by_factor:
                gone += [product for products in by_factor.values() for product in products]
                place = next(number for number, row in enumerate(rows) if row is total)
                rows[place : place + 1] = self._sum(total, terms, by_factor)
                rows = [row for row in rows if not any(row is each for each in gone)]
        return replace(self.block, instructions=tuple(rows))

    def _own(self, value: str, *opcodes: str) -> Instruction | None:
        """The instruction that computes a value here by one of these operations, if only one instruction uses it."""
        each = self.flow.instruction(value)
        if each is None or each.opcode not in opcodes or self.flow.defined[value][0] != self.block.label:
            return None
        return each if len(self.flow.users.get(value, ())) == 1 else None

    def _is_stored(self, each: Instruction) -> bool:
        """Whether a sum is only stored: GCC adds in words if the sum is shifted first."""
        users = self.flow.users.get(each.result or "", ())
        return bool(users) and all(user.opcode == "store" for user in users)

    def _terms(self, total: Instruction) -> tuple[list[str], list[Instruction]]:
        """The terms of a sum, and the sums in between."""
        terms, sums = [], []
        for value in total.operands:
            inner = self._own(value, "add")
            more, within = self._terms(inner) if inner is not None else ([value], [])
            terms += more
            sums += [*([inner] if inner is not None else []), *within]
        return terms, sums

    def _by_factor(self, terms: list[str]) -> dict[int, list[Instruction]]:
        """The products among the terms, by factors that several of them share."""
        found = defaultdict[int, list[Instruction]](list)
        for value in terms:
            product = self._own(value, "mul", "shl")
            if product is not None and is_number(product.operands[1]):
                number = int(product.operands[1])
                found[1 << number if product.opcode == "shl" else number].append(product)
        return {factor: products for factor, products in found.items() if len(products) > 1}

    def _sum(
        self, total: Instruction, terms: list[str], by_factor: dict[int, list[Instruction]]
    ) -> Iterator[Instruction]:
        """The terms added up anew."""
        gone = {product.result for products in by_factor.values() for product in products}
        kept = [value for value in terms if value not in gone]
        for number, (factor, products) in enumerate(by_factor.items()):
            name = f"{total.result}{COMMON}{number}"
            yield from _added(name, [each.operands[0] for each in products], total)
            yield _computed("mul", f"{name}.times", name, str(factor), total)
            kept.append(f"{name}.times")
        yield from _added(total.result or "", kept, total)


def _added(name: str, terms: list[str], at: Instruction) -> Iterator[Instruction]:
    before = terms[0]
    for number, term in enumerate(terms[1:], 1):
        result = name if number == len(terms) - 1 else f"{name}{COMMON}.{number}"  # not as LLVM names copies
        yield _computed("add", result, before, term, at)
        before = result


def _computed(opcode: str, result: str, left: str, right: str, at: Instruction) -> Instruction:
    return written(result, f"{opcode} i{at.bits} {left}, {right}", (left, right), at)
