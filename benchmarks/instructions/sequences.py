"""Random sequences of instructions: made from the table itself, run by bfsim's translator.

A sequence is straight code. It starts with registers set by chance, numbers at the edges of saturation among them, and
may load from `SCRATCH`, of which every word is as `scratch_bytes` says.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from collections.abc import Sequence as Several
from dataclasses import dataclass
from random import Random

import numpy as np

from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.form import Beside, Form
from bfsim.blackfin.instructions.forms import (
    accumulators,
    arithmetic,
    bitfields,
    conditions,
    immediates,
    loads_dag,
    moves,
    multiplications,
    shifts,
    sums,
    video,
)
from bfsim.blackfin.instructions.operands import Operand
from bfsim.blackfin.instructions.registers import ACCUMULATORS, DAG, DATA, ENCODED
from bfsim.machine_code import Effort

POINTERS = tuple(f"P{number}" for number in range(5))
"""Those that sequences may use; the simulated program needs the others."""
REGISTERS = (*DATA, *POINTERS, *DAG, *ACCUMULATORS, "ASTAT")
SCRATCH, SCRATCH_BYTES = 0x100000, 8192
CODE = 0x1000
HALT = struct.pack("<H", 0xF8C4)
BUNDLE = 0x0800
BATCH = 16
DEPARTURES = {
    (
        "quad",
        "ASR",
    ): "R0 = R2 +|+ R3, R1 = R2 -|- R3 (S, ASR): it makes 0x7fff of -1 + 1, and sets V where nothing overflows",
    (
        "quad",
        "ASL",
    ): "R0 = R2 +|+ R3, R1 = R2 -|- R3 (ASL): it sets V otherwise than where a result does not fit",
    (
        "add_subtract_accumulators",
        "",
    ): "R0 = A1 + A0, R1 = A1 - A0: its V is a variable that it sets only where it overflows",
}
"""What is not compared with GNU's simulator, for bfsim does as the programming reference says, by what a form does and its scale."""
COUNTS = {"lshift_half": range(-31, 32), "shift_by_register": range(64)}
"""Counts of shifts whose others have no meaning in the simulator's C."""
SPACING = 256
"""Of the sequences in memory, in bytes."""

DSP_GROUPS = tuple(
    tuple(form for form in group.FORMS if (form.does, form.given.get("scale", "")) not in DEPARTURES)
    for group in (multiplications, sums, accumulators, video, shifts, bitfields)
)
VIDEO = DSP_GROUPS[3]
STACK = {"push", "pop", "push_multiple", "pop_multiple"}
PLAIN = tuple(
    form
    for group in (arithmetic, conditions, immediates, moves)
    for form in group.FORMS
    if form.does not in STACK and "RND_MOD" not in form.text
)
""""RND_MOD: GNU's simulator always rounds half to even."""
NOP = Form("nothing", "0000 0000 0000 0000", "NOP", beside=Beside.EITHER)
WORDS = tuple(
    form for form in loads_dag.FORMS if form.does == "load_indexed" and form.given["half"] == "whole"
)
HALVES = tuple(
    form for form in loads_dag.FORMS if form.does == "load_indexed" and form.given["half"] != "whole"
)
STEPS = {
    size: tuple(
        form
        for form in loads_dag.FORMS
        if form.does == "modify_index" and form.given["step"] in {size, -size}
    )
    for size in (2, 4)
}
BESIDE = {
    "words": (NOP, *WORDS, *STEPS[4]),
    "halves": (NOP, *HALVES, *STEPS[2]),
    "bytes": (NOP, *WORDS, *STEPS[2]),
}
"""What may stand beside a DSP instruction, by what a sequence loads: its indexes must be, or stay, multiples of 4 or of 2, or of nothing."""
PARTS = ("A0.X", "A0.W", "A1.X", "A1.W")

EDGES = (
    0,
    1,
    -1,
    0x7FFF,
    0x8000,
    0xFFFF,
    -0x8000,
    0x7FFFFFFF,
    -0x80000000,
    0x10000,
    0x7FFF8000,
    0x7FFF7FFF,
    0x80008000,
    0x80007FFF,
)
ACCUMULATOR_EDGES = (*EDGES, (1 << 39) - 1, -(1 << 39), 0x80000000, 0xFFFFFFFF, -0x80000001, 0x7FFFFFFFF)
STATUS_BITS = 0x30F306F
"""The flags of ASTAT, all but RND_MOD, which GNU's simulator does not honour."""

Registers = dict[str, int]


@dataclass(frozen=True, slots=True)
class Sequence:
    """Instructions, and the registers before them."""

    code: bytes
    before: Registers


def random_registers(rng: Random) -> Registers:
    """Return registers by chance; the indexes are at words of the scratch memory, with circular buffers there or none."""
    found = {each: _number(rng, 32, EDGES) for each in (*DATA, *POINTERS)}
    for number in range(4):
        base = SCRATCH + 2048 * number + 1024
        found[f"I{number}"] = base + 4 * rng.randrange(32) + rng.choice((0, 0, rng.randrange(4)))
        found[f"M{number}"] = 4 * rng.randrange(-8, 8) & 0xFFFFFFFF
        found[f"B{number}"] = base
        found[f"L{number}"] = rng.choice((0, 128))
    for each in ACCUMULATORS:
        value = _number(rng, 40, ACCUMULATOR_EDGES)
        found[each] = value - (value >> 39 << 40)
    found["ASTAT"] = rng.getrandbits(32) & STATUS_BITS
    return {each: found[each] for each in REGISTERS}


def _number(rng: Random, bits: int, edges: Several[int]) -> int:
    number = rng.choice(edges) + rng.choice((-1, 0, 0, 1)) if rng.random() < 0.5 else rng.getrandbits(bits)
    return number & (1 << bits) - 1


@dataclass(frozen=True, slots=True)
class Start:
    """Registers, and what may be loaded with them: "words", "halves", or "bytes", which are words from anywhere."""

    loads: str
    registers: Registers


def random_start(rng: Random) -> Start:
    """Return registers by chance, with indexes for loads by chance."""
    loads = rng.choice(tuple(BESIDE))
    registers = random_registers(rng)
    if loads != "bytes":
        registers |= {each: registers[each] & ~3 for each in ("I0", "I1", "I2", "I3")}
    return Start(loads, registers)


def random_sequence(rng: Random, length: int, start: Start) -> Sequence:
    """Return `length` instructions by chance, one in five of them no DSP instruction, and some bundles of three."""
    return Sequence(b"".join(_instruction(rng, start.loads) for _ in range(length)), start.registers)


def _instruction(rng: Random, loads: str) -> bytes:
    group = rng.choice(DSP_GROUPS) if rng.random() < 0.8 else PLAIN
    form = rng.choice(group)
    encoding, operands = _encoding(rng, form)
    if form.does in COUNTS:
        return _set(str(operands["s"]), rng.choice(COUNTS[form.does])) + _code(encoding, form)
    if group is PLAIN:
        return _code(encoding, form)
    # A word may be loaded from anywhere beside video instructions alone.
    if rng.random() < 0.7 or (loads == "bytes" and group is not VIDEO):
        return _code(encoding, form)
    used = {
        f"R{int(str(each)[1]) + more}" for each in operands.values() if str(each)[0] == "R" for more in (0, 1)
    }
    first, used = _beside(rng, BESIDE[loads], used)
    second, _ = _beside(rng, [each for each in BESIDE[loads] if each.beside is Beside.EITHER], used)
    return struct.pack("<4H", encoding >> 16 | BUNDLE, encoding & 0xFFFF, first, second)


def _set(register: str, number: int) -> bytes:
    """Return R0 = number (X)."""
    return struct.pack("<H", 0x6000 | (number & 0x7F) << 3 | int(register[1]))


def _code(encoding: int, form: Form) -> bytes:
    return (
        struct.pack("<H", encoding)
        if form.length == 2
        else struct.pack("<HH", encoding >> 16, encoding & 0xFFFF)
    )


def _beside(rng: Random, forms: Several[Form], used: set[str]) -> tuple[int, set[str]]:
    """Return an instruction that changes no register that is used already, and all that are used then."""
    while True:
        encoding, operands = _encoding(rng, rng.choice(forms))
        registers = {str(each) for each in operands.values()}
        if used.isdisjoint(registers):
            return encoding, used | registers


def _encoding(rng: Random, form: Form) -> tuple[int, Mapping[str, Operand]]:
    """Return an encoding of a form by chance, which touches only registers that sequences may use."""
    while True:
        encoding = form.match
        for place in (place for places in form.fields.values() for place in places):
            encoding |= rng.getrandbits(1) << place
        operands = form.operands(encoding, 0)
        if operands is not None and all(_may_use(*each) for each in operands.items()):
            return encoding, operands


def _may_use(letter: str, operand: Operand) -> bool:
    """Return whether it is no register, or one that may be read, or written if it is d; an index that is written leads anywhere."""
    if operand not in ENCODED:
        return True
    return operand in {*DATA, *POINTERS, *PARTS} or (letter != "d" and operand in DAG)


def translated(sequences: Several[Sequence]) -> list[Registers]:
    """Return the registers behind sequences, as bfsim computes them."""
    starts = range(0, len(sequences), BATCH)
    return [each for start in starts for each in _translated(sequences[start : start + BATCH])]


def _translated(sequences: Several[Sequence]) -> list[Registers]:
    space = AddressSpace()
    space.add(SCRATCH, SCRATCH_BYTES)
    space.at(SCRATCH, SCRATCH_BYTES)[:] = np.frombuffer(scratch_bytes(), np.uint8)
    space.add(CODE, SPACING * len(sequences))
    starts = [CODE + SPACING * number for number in range(len(sequences))]
    for start, each in zip(starts, sequences, strict=True):
        code = each.code + HALT
        space.at(start, len(code))[:] = np.frombuffer(code, np.uint8)
    processor = Processor(space, entries=set(starts), effort=Effort.NONE)
    return [_run(processor, start, each.before) for start, each in zip(starts, sequences, strict=True)]


def _run(processor: Processor, start: int, before: Registers) -> Registers:
    state = processor.state
    for register, value in before.items():
        state[register] = value
    state["PC"] = start
    event = processor.run()
    assert event is Event.HALT, event
    return {register: state[register] for register in REGISTERS}


def scratch_bytes() -> bytes:
    """Return what the scratch memory holds."""
    return Random(0).randbytes(SCRATCH_BYTES)
