"""Relocations of Blackfin ELF files, as data: what a linker writes into code and data once addresses are known.

Numbers and fields: [BFD] the ELF back end of binutils 2.40 for the Blackfin. Only VisualDSP++ has those of LSETUP,
which binutils itself applies wrongly: GNU's assembler knows both ends of a loop, which are in its own section.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum


class RelocationKind(IntEnum):
    """Types of relocations that assemblers make for programs without position-independent code, by their ELF numbers."""

    LOOP_BEGIN = 0x01
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
    LOOP_END = 0x13
    DEBUG_WORD = 0xFF
    """[seen] Addresses in the debugging information of VisualDSP++ 5."""


SECOND_HALF = {
    RelocationKind.IMMEDIATE_16, RelocationKind.LOW_HALF, RelocationKind.HIGH_HALF, RelocationKind.JUMP_X, RelocationKind.CALL_OR_JUMP_24, RelocationKind.JUMP_L, RelocationKind.CALL_X,
}  # fmt: skip
"""Kinds that point to the second half of an instruction, or [seen] in object files of VisualDSP++ 5 to the first."""
HALF_BYTES = 2
INDEPENDENT = (*range(0x14, 0x22), 0x40, 0x41)
"""[seen] Kinds of position-independent code: of FDPIC, and of shared libraries that have numbers."""
NOTHING = (0x00, 0xD2)
"""Kinds that write nothing: R_BFIN_UNUSED0, and [seen] VisualDSP++'s, so that its linker keeps a symbol that code needs."""
PUSH, PUSH_CONSTANT = 0xE0, 0xE1
"""Put the value of a symbol, or an addend, on a stack; the next relocation of the kinds above writes what is on its top."""
OPERATIONS: dict[int, Callable[[int, int], int]] = {
    0xE2: operator.add, 0xE3: operator.sub, 0xE4: operator.mul, 0xE7: operator.lshift, 0xE8: operator.rshift,
    0xE9: operator.and_, 0xEA: operator.or_, 0xEB: operator.xor,
}  # fmt: skip
"""Kinds that take two values from that stack and put one there."""


@dataclass(frozen=True, slots=True)
class RelocatedField:
    """The `bits` lowest of a little-endian number of `nbytes`, `before` bytes ahead of where the relocation points.

    They take the value shifted right by `shift`, counted from the instruction's address if it is `relative`. A value
    that does not fit is refused unless the field takes a part of it (`is_part`), such as half of an address. `forward`:
    it cannot be negative. `over`: how many of the lowest bits are not the field's.
    """

    nbytes: int
    bits: int
    shift: int = 0
    relative: bool = False
    before: int = 0
    is_part: bool = False
    forward: bool = False
    over: int = 0


LONG = RelocatedField(nbytes=4, bits=24, shift=1, relative=True, before=2)
"""The address of a long jump or a call."""

FIELDS: dict[RelocationKind, RelocatedField] = {
    RelocationKind.LOOP_BEGIN: RelocatedField(2, 4, shift=1, relative=True, forward=True),
    RelocationKind.LOOP_END: RelocatedField(4, 10, shift=1, relative=True, before=2, forward=True, over=16),
    RelocationKind.IF_CC_JUMP: RelocatedField(2, 10, shift=1, relative=True),
    RelocationKind.JUMP: RelocatedField(2, 12, shift=1, relative=True),
    RelocationKind.JUMP_S: RelocatedField(2, 12, shift=1, relative=True),
    RelocationKind.JUMP_X: LONG, RelocationKind.CALL_OR_JUMP_24: LONG, RelocationKind.JUMP_L: LONG, RelocationKind.CALL_X: LONG,
    RelocationKind.IMMEDIATE_16: RelocatedField(2, 16),
    RelocationKind.LOW_HALF: RelocatedField(2, 16, is_part=True),
    RelocationKind.HIGH_HALF: RelocatedField(2, 16, shift=16, is_part=True),
    RelocationKind.BYTE: RelocatedField(1, 8),
    RelocationKind.HALFWORD: RelocatedField(2, 16),
    RelocationKind.WORD: RelocatedField(4, 32, is_part=True),
    RelocationKind.DEBUG_WORD: RelocatedField(4, 32, is_part=True),
}  # fmt: skip
