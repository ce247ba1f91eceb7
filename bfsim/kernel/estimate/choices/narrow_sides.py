"""Choices that are stored as bytes or half-words: each side computes the narrow value itself, even if a test also needs the word.

Of `c[i] = -d if d < 0 else d`, with `d = a[i] - b[i]` of bytes, C converts both sides [COND_EXPR in convert_to_integer_1 of convert.cc of GCC 12]: one
is the difference of the bytes, the other one that the other way round [narrowing conversions of arithmetic in match.pd]. No branch goes away then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from bfsim.kernel.estimate.choices.narrow_choices import NARROWED, is_narrowed, stored_bits
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    phi_of,
    renamed,
    written,
)
from bfsim.kernel.ir.unused import without_unused
from bfsim.kernel.ir.widths import WORD

DEEPEST = 4
"""[ours] Operations of an expression, one in the other, that are looked through."""
COMPUTED = (*NARROWED, "shl")
PURE = (*COMPUTED, "lshr", "ashr", "trunc", "zext", "sext")


def with_narrow_sides(routine: Routine) -> Routine:
    """Return `routine` with choices whose sides compute narrow values."""
    done = set[str]()
    while True:
        flow = ControlFlow(routine)
        phi = next((each for each in _choices(flow) if (each.result or "") not in done), None)
        if phi is None:
            return routine
        done.add(phi.result or "")
        blocks = _with_sides(flow, phi)
        if blocks is not None:
            narrow = replace(routine, blocks=tuple(blocks.values()))
            routine = without_unused(narrow, PURE)


def _choices(flow: ControlFlow) -> Iterator[Instruction]:
    for label in flow.order:
        rows = (each for each in flow.blocks[label].instructions if each.opcode == "phi")
        yield from (each for each in rows if is_narrowed(flow, each))


def _with_sides(flow: ControlFlow, phi: Instruction) -> dict[str, BasicBlock] | None:
    """Return the blocks in which `phi` chooses of narrow values, or None if nobody else wants what the sides compute."""
    home = flow.defined[phi.result or ""][0]
    cuts = flow.users.get(phi.result or "", []) if phi.bits == WORD else []
    sides = [_Side(flow, phi, number) for number in range(len(phi.operands))]
    if not any(each.shares for each in sides) or any(each.opcode != "trunc" for each in cuts):
        return None
    blocks, chosen = dict(flow.blocks), list[tuple[str, str]]()
    for label, side in zip(arms_of(phi), sides, strict=True):
        source = label
        if side.rows and len(set(blocks[label].successors)) > 1:
            source = f"{label}.on.{home}"
            put_between(blocks, label, home, source)
        *rows, end = blocks[source].instructions
        blocks[source] = replace(blocks[source], instructions=(*rows, *side.rows, end))
        chosen.append((side.value, source))
    narrow = phi_of(phi.result or "", f"i{stored_bits(flow, phi)}", chosen, phi)
    return {label: _with_choice(block, narrow, cuts) for label, block in blocks.items()}


def _with_choice(block: BasicBlock, narrow: Instruction, cuts: Sequence[Instruction]) -> BasicBlock:
    """Return a block with the choice `narrow` in place of one of words, and of what cuts that down."""
    names = {each.result or "": narrow.result or "" for each in cuts}
    rows = (renamed(each, names) for each in block.instructions if each not in cuts)
    return replace(
        block, instructions=tuple(narrow if each.result == narrow.result else each for each in rows)
    )


class _Side:
    """A side of a choice: the narrow `value` that it brings, the `rows` that compute it, and whether others share what it computed as a word."""

    def __init__(self, flow: ControlFlow, phi: Instruction, number: int) -> None:
        self.flow, self.at = flow, phi
        self.bits, self.name = stored_bits(flow, phi), f"{phi.result}.side.{number}"
        self.rows: list[Instruction] = []
        self.shares = False
        value = phi.operands[number]
        narrow = self._narrow(value, DEEPEST)
        if narrow is None:
            self.rows, self.shares, narrow = [], False, value
            if phi.bits == WORD:
                narrow = f"{self.name}.cut"
                self.rows = [written(narrow, f"trunc i{WORD} {value} to i{self.bits}", (value,), phi)]
        self.value = narrow

    def _narrow(self, value: str, depth: int) -> str | None:
        """Compute a word as narrow, and return its name; None if that is not done."""
        if is_number(value):
            half = 1 << (self.bits - 1)
            return str((int(value) + half) % (2 * half) - half)
        made = self.flow.instruction(value)
        if made is None or not depth:
            return None
        if made.opcode == "zext" and made.bits == self.bits:
            return made.operands[0]
        if made.opcode == "trunc":
            return self._narrow(made.operands[0], depth)
        return self._computed(made, depth) if self._is_narrowed(made) else None

    def _is_narrowed(self, made: Instruction) -> bool:
        """Whether the low bits of what an operation computes follow from those of its operands."""
        amount = made.operands[1] if made.opcode == "shl" else "0"
        is_known = amount.isdigit() and int(amount) < self.bits
        return made.opcode in COMPUTED and made.bits in (WORD, self.bits) and is_known

    def _computed(self, made: Instruction, depth: int) -> str | None:
        left, right = made.operands
        inner = self.flow.instruction(right)
        self.shares = self.shares or len(self.flow.users.get(made.result or "", [])) > 1
        if made.opcode == "sub" and is_number(left) and inner is not None and inner.opcode == "sub":
            self.shares = self.shares or len(self.flow.users.get(right, [])) > 1
            first, second, number = (self._narrow(each, depth - 1) for each in (*inner.operands, left))
            if first is None or second is None or number is None:
                return None
            more = second if number == "0" else self._row("add", second, number)  # n - (x - y) is (y + n) - x
            return self._row("sub", more, first)
        x, y = self._narrow(left, depth - 1), self._narrow(right, depth - 1)
        return None if x is None or y is None else self._row(made.opcode, x, y)

    def _row(self, opcode: str, *operands: str) -> str:
        text = f"{opcode} i{self.bits} {', '.join(operands)}"
        name = f"{self.name}.{len(self.rows)}"
        self.rows.append(Instruction(name, opcode, text, operands, self.at.line, location=self.at.location))
        return name
