"""Relocations of Blackfin ELF files, as data: what a linker writes into code and data once addresses are known.

Numbers and fields: [BFD] the ELF back end of binutils 2.40 for the Blackfin. Those of LSETUP, which binutils itself applies wrongly,
are none of them: both ends of a loop are in its own section, and the assembler knows them.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum


class Kind(IntEnum):
    """Types of relocations that assemblers make for programs without position-independent code, by their ELF numbers."""

    IF_CC_JUMP = 0x03
    JUMP = 0x04
    IMMEDIATE_16 = 0x05
    LOW_HALF = 0x06
    HIGH_HALF = 0x07
    JUMP_S = 0x08
    JUMP_X = 0x09
    CALL_OR_JUMP_24 = 0x0A
    JUMP_L = 0x0D
    CALL_X = 0x0E
    BYTE = 0x10
    HALFWORD = 0x11
    WORD = 0x12


@dataclass(frozen=True, slots=True)
class RelocatedField:
    """The `bits` lowest of a little-endian number of `nbytes`, `before` bytes ahead of where the relocation points.

    They take the value shifted right by `shift`, from the instruction's address if it is `relative`. What does not fit is refused
    unless the field takes a part of the value, as halves of an address do.
    """

    nbytes: int
    bits: int
    shift: int = 0
    relative: bool = False
    before: int = 0
    is_part: bool = False


_LONG = RelocatedField(nbytes=4, bits=24, shift=1, relative=True, before=2)

FIELDS: dict[Kind, RelocatedField] = {
    Kind.IF_CC_JUMP: RelocatedField(2, 10, shift=1, relative=True),
    Kind.JUMP: RelocatedField(2, 12, shift=1, relative=True),
    Kind.JUMP_S: RelocatedField(2, 12, shift=1, relative=True),
    Kind.JUMP_X: _LONG, Kind.CALL_OR_JUMP_24: _LONG, Kind.JUMP_L: _LONG, Kind.CALL_X: _LONG,
    Kind.IMMEDIATE_16: RelocatedField(2, 16),
    Kind.LOW_HALF: RelocatedField(2, 16, is_part=True),
    Kind.HIGH_HALF: RelocatedField(2, 16, shift=16, is_part=True),
    Kind.BYTE: RelocatedField(1, 8),
    Kind.HALFWORD: RelocatedField(2, 16),
    Kind.WORD: RelocatedField(4, 32, is_part=True),
}  # fmt: skip
