"""Bytes → instructions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

from bfsim.blackfin.instructions.form import Form
from bfsim.blackfin.instructions.forms import TABLE
from bfsim.blackfin.instructions.operands import Operand
from bfsim.errors import BfsimError

BUNDLE = 0x0800
"""The bit in the first halfword of a DSP instruction: two 16-bit instructions follow, which are issued with it."""
LONGEST_BYTES = 8


class InstructionError(BfsimError, ValueError):
    """Raised for bytes that are not an instruction, or not one that the processor has."""


@dataclass(frozen=True, slots=True)
class Operation:
    """A form of instruction with its operands: alone, or as one of three that are issued together."""

    form: Form
    operands: Mapping[str, Operand]


@dataclass(frozen=True, slots=True)
class Instruction:
    """What is issued at once: one operation, or the three of a bundle. `length`: in bytes, 2, 4 or 8."""

    address: int
    length: int
    operations: tuple[Operation, ...]

    @property
    def end(self) -> int:
        """The address of what follows."""
        return self.address + self.length & 0xFFFFFFFF


def decode(code: bytes, address: int) -> Instruction:
    """Return the instruction that `code` begins with; only the first 8 bytes count, and there may be fewer.

    Raises InstructionError if the bytes fit none of the table's forms.
    """
    operation = _operation(code, address, 0 if _is_bundle(code) else None)
    if operation is None:
        raise _refusal(code, address)
    if not _is_bundle(code):
        return Instruction(address, operation.form.length, (operation,))
    beside = (_operation(code[4:6], address, 1), _operation(code[6:8], address, 2))
    if beside[0] is None or beside[1] is None:
        raise _refusal(code, address)
    return Instruction(address, LONGEST_BYTES, (operation, beside[0], beside[1]))


def disassemble(code: bytes, address: int) -> Iterator[Instruction]:
    """Yield the instructions of `code`, one after the other. Raises InstructionError as `decode` does."""
    start = 0
    while start < len(code):
        instruction = decode(code[start : start + LONGEST_BYTES], address + start)
        yield instruction
        start += instruction.length


def _is_bundle(code: bytes) -> bool:
    """Whether three are issued at once: only DSP instructions, which begin with 110, have the bit."""
    first = int.from_bytes(code[:2], "little")
    return first & 0xE000 == 0xC000 and bool(first & BUNDLE)


def _operation(code: bytes, address: int, place: int | None) -> Operation | None:
    """Return what the first halfwords of `code` ask for, in a `place` of a bundle if it stands in one."""
    if len(code) < 2:
        return None
    short = int.from_bytes(code[:2], "little")
    long = short << 16 | int.from_bytes(code[2:4], "little") if len(code) >= 4 else None
    for form in _candidates(short >> 8):
        encoding = short if form.length == 2 else long
        if encoding is None or (place is not None and place not in form.beside.value):
            continue
        operands = form.operands(encoding, address)
        if operands is not None:
            return Operation(form, operands)
    return None


@cache
def _candidates(first_byte: int) -> tuple[Form, ...]:
    """Return the forms whose encoding may begin with such a byte, in the order of the table."""
    return tuple(
        form
        for form in TABLE
        if not (first_byte ^ form.match >> (shift := 8 * form.length - 8)) & form.mask >> shift
    )


def _refusal(code: bytes, address: int) -> InstructionError:
    shown = code[:LONGEST_BYTES].hex(" ") or "the end of the code"
    return InstructionError(
        f"an instruction must stand at {address:#010x}, but the bytes there are none of a Blackfin: {shown}; what is run must be "
        "code for the Blackfin, and its jumps must lead to code"
    )
