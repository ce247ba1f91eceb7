"""Kinds of operands: what the bits of a field mean, and how GNU objdump prints it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bfsim.blackfin.instructions.registers import DATA, ENCODED, POINTERS

Operand = int | str
"""A number, or the name of a register."""


def number_text(value: Operand) -> str:
    """Print a number as objdump does, -0x10 or 0x10, or a name as it is."""
    return value if isinstance(value, str) else f"{'-' if value < 0 else ''}{abs(value):#x}"


@dataclass(frozen=True, slots=True)
class OperandKind:
    """`value`: what the bits of a field mean in an instruction at an address, or None. `text`: how that is printed."""

    value: Callable[[int, int], Operand | None]
    text: Callable[[Operand], str] = number_text


NUMBER = OperandKind(lambda raw, _: raw)


def signed(bits: int, scale: int = 1) -> OperandKind:
    """Return the kind of a two's complement number, times `scale`."""
    return OperandKind(lambda raw, _: _signed(raw, bits) * scale)


def unsigned(scale: int = 1) -> OperandKind:
    """Return the kind of a number, times `scale`."""
    return OperandKind(lambda raw, _: raw * scale)


def decimal(kind: OperandKind) -> OperandKind:
    """Return a kind that is printed in decimal."""
    return OperandKind(kind.value, str)


def register(names: Sequence[str]) -> OperandKind:
    """Return the kind of a register by its number; an empty name is reserved."""
    return OperandKind(lambda raw, _: (names[raw] or None) if raw < len(names) else None)


def target(bits: int, *, forward: bool = False) -> OperandKind:
    """Return the kind of an address in code, as its distance from the instruction in halfwords."""
    return OperandKind(
        lambda raw, address: address + 2 * (raw if forward else _signed(raw, bits)) & 0xFFFFFFFF
    )


def option(*texts: str) -> OperandKind:
    """Return the kind of a number that is printed as one of `texts`; larger numbers mean nothing."""
    return OperandKind(lambda raw, _: raw if raw < len(texts) else None, lambda value: texts[int(value)])


def shift(*, right: bool) -> OperandKind:
    """Return the kind of a six-bit shift count, positive to the left; for shifts to the right, objdump prints it negated."""
    return OperandKind(
        lambda raw, _: _signed(raw, 6), lambda count: number_text((-int(count) if right else int(count)) & 63)
    )


def mode(*left_out: str, mixed: str = "") -> OperandKind:
    """Return the kind of a multiplication's mode, a name; `mixed` is printed before it."""

    def text(name: Operand) -> str:
        names = ", ".join(filter(None, (mixed, str(name))))
        return f" ({names})" if names else ""

    return OperandKind(lambda raw, _: None if MODES.get(raw) in left_out else MODES.get(raw), text)


def crossing(scale: str = "") -> OperandKind:
    """Return the kind of the options of a vector sum: 1 exchanges its halves, 2 saturates; `scale` is printed after them."""
    names = (", ".join(filter(None, (each, scale))) for each in ("", "CO", "S", "SCO"))
    return option(*(f" ({each})" if each else "" for each in names))


MODES = {
    0: "", 1: "S2RND", 2: "T", 3: "W32", 4: "FU", 6: "TFU", 8: "IS", 9: "ISS2", 11: "IH", 12: "IU"
}  # fmt: skip
"""Modes of multiplications, by their encoding: names in assembler."""


def _signed(raw: int, bits: int) -> int:
    return raw - (raw >> bits - 1 << bits)


KINDS = {
    "R": register(DATA),
    "P": register(POINTERS),
    "RP": register((*DATA, *POINTERS)),
    "I": register(("I0", "I1", "I2", "I3")),
    "M": register(("M0", "M1", "M2", "M3")),
    "LC": register(("LC0", "LC1")),
    "A": register(("A0", "A1")),
    "any": register(ENCODED),
    "dag": register(ENCODED[:32]),
    "count": unsigned(),
    "count2": unsigned(2),
    "count4": unsigned(4),
    "decimal": decimal(unsigned()),
    "imm3": signed(3),
    "imm5": signed(5),
    "imm6": signed(6),
    "imm7": signed(7),
    "imm16": signed(16),
    "imm16x2": signed(16, 2),
    "imm16x4": signed(16, 4),
    "frame": OperandKind(lambda raw, _: 4 * (raw - 32)),
    "target4": target(4, forward=True),
    "target10": target(10),
    "target12": target(12),
    "target24": target(24),
    "end10": target(10, forward=True),
    "even": register(("R0", "R2", "R4", "R6")),
    "odd": OperandKind(register(("R0", "R2", "R4", "R6")).value, lambda even: f"R{int(str(even)[1]) + 1}"),
    "pair": register(("R1:0", "", "R3:2", "", "", "", "", "")),
    "half": option("L", "H"),
    "sign": option("+", "-"),
    "assign": option("=", "+=", "-="),
    "saturation": option(" (NS)", " (S)"),
    "crossing": crossing(),
    "crossingASR": crossing("ASR"),
    "crossingASL": crossing("ASL"),
    "reverse": option("", " (R)"),
    "and_reverse": option("", ", R"),
    "rounding": option("RND", "T"),
    "end": option("LO", "HI"),
    "comparison": register(("GT", "GE", "LT", "LE")),
    "right": shift(right=True),
    "right5": OperandKind(shift(right=True).value, lambda count: number_text(_signed(-int(count) & 31, 5))),
    "left": shift(right=False),
    "mixed": option("", " (M)"),
    "mode": mode("W32"),
    "mixed_mode": mode("W32", mixed="M"),
    "sum_mode": mode(),
    "mixed_sum_mode": mode(mixed="M"),
    "wide_mode": mode("W32", "T", "TFU", "IH"),
    "mixed_wide_mode": mode("W32", "T", "TFU", "IH", mixed="M"),
    "wide_product_mode": mode("W32", "T", "TFU", "IH", "IU"),
    "mixed_wide_product_mode": mode("W32", "T", "TFU", "IH", "IU", mixed="M"),
}
"""Kinds by their names in forms. Numbers in a name are bits, or bytes after an x."""
