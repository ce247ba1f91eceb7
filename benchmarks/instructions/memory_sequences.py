"""Sequences with loads, stores and the stack under the GNU simulator and translated: registers, flags, memory and cycles.

    python -m benchmarks.instructions.memory_sequences              20 sequences of 100 instructions
    python -m benchmarks.instructions.memory_sequences 500 --seed 7
    python -m benchmarks.instructions.memory_sequences --does add_and_shift      of one semantics only
    python -m benchmarks.instructions.memory_sequences 6 --record tests/blackfin/data/runs.json

Needs a bfin-elf toolchain on PATH. The instructions are all but those of the DSP, which `instruction_set.py` compares,
and those of control flow, for which `control.py` has programs; what is recorded has those too. The pointer of an access
is set before it, to a small memory. Prints the shortest part of a sequence that shows a difference. Not compared:
shifts by a register of 2^31 and more, where the simulator shifts by negative numbers, which C does not define.
"""

from __future__ import annotations

import argparse
import json
import random
import re
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.instructions.control import PROGRAMS, assembled
from bfsim.blackfin.control_flow.blocks import COMPUTED, DIRECT, EVENTS
from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.instructions.decode import InstructionError, Operation, decode
from bfsim.blackfin.instructions.form import Beside, Form
from bfsim.blackfin.instructions.forms import TABLE
from bfsim.blackfin.instructions.registers import ENCODED
from bfsim.blackfin.instructions.text import text

CODE, ROOM_BYTES, MEMORY, MEMORY_BYTES = 0x1000, 0x10000, 0x20000, 256
STARTED = [each for each in ENCODED[:54] if each and each != "ASTAT"]
SHOWN = ["CYCLES", *STARTED, "ASTAT"]  # CYCLES first: printing takes cycles too
SYSTEM = {"USP", "SEQSTAT", "SYSCFG", "RETI", "RETX", "RETN", "RETE", "EMUDAT"}
"""They mean nothing without an event controller."""
LEFT_OUT = DIRECT | COMPUTED | EVENTS | {"loop_setup", "disable_interrupts", "enable_interrupts"}
EDGES = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x8000, 0x7FFF, 0xFFFF, 0x80000001, 0x10000, 0x1F, 0x20)
"""Half of all values are one of these: where carries and overflows are."""


@dataclass(frozen=True, slots=True)
class Step:
    """An instruction, behind what sets the registers that it needs."""

    before: bytes
    code: bytes

    def __str__(self) -> str:
        return f"{self.code.hex(' ')}  {text(decode(self.code, 0))}"


@dataclass(frozen=True, slots=True)
class Outcome:
    """What is left: registers by their names, and the memory."""

    registers: Mapping[str, int]
    memory: bytes


def encoded(form: Form, **values: int) -> bytes:
    """Return the bytes of a form; `values` are the bits of its fields by their letters."""
    encoding = form.match
    for letter, value in values.items():
        places = form.fields[letter]
        for place, bit in zip(places, range(len(places) - 1, -1, -1), strict=True):
            encoding |= (value >> bit & 1) << place
    halves = (encoding >> 16, encoding & 0xFFFF) if form.length == 4 else (encoding,)
    return b"".join(each.to_bytes(2, "little") for each in halves)


@cache
def the(does: str) -> Form:
    """Return the first form of a semantics."""
    return next(each for each in TABLE if each.does == does)


def setting(register: str, value: int) -> bytes:
    """Return the code that gives a register a value; through R0 if it takes no constant."""
    number = ENCODED.index(register)
    if number >= 32:
        return setting("R0", value) + encoded(the("move"), d=number, s=0)
    low, high = (
        encoded(the("set_low"), d=number, i=value & 0xFFFF),
        encoded(the("set_high"), d=number, i=value >> 16),
    )
    return low + high


def word(chance: random.Random) -> int:
    """Return a value of a register."""
    return chance.choice(EDGES) if chance.random() < 0.5 else chance.getrandbits(32)


def step(form: Form, chance: random.Random) -> Step | None:
    """Return a form with random fields, or None if they are not allowed."""
    code = encoded(
        form, **{letter: chance.getrandbits(len(places)) for letter, places in form.fields.items()}
    )
    try:
        operation = decode(code, 0).operations[0]
    except InstructionError:
        return None
    if operation.form is not form or not SYSTEM.isdisjoint(map(str, operation.operands.values())):
        return None
    return Step(_before(operation, chance), code)


def _before(operation: Operation, chance: random.Random) -> bytes:
    """Return what sets the pointer of an access, the amount of a shift, and now and then other operands."""
    does, operands = operation.form.does, {**operation.operands, **operation.form.given}
    middle = MEMORY + 4 * chance.randrange(20, 44)
    if does in {"load", "store", "load_half", "store_half", "test_and_set"}:
        return setting(str(operands["p"]), middle - int(operands.get("n", 0)) & 0xFFFFFFFF)
    if does == "cache":
        return setting(str(operands["p"]), MEMORY)  # the simulator wants it where a cache line begins
    if does in {"load_indexed", "store_indexed"}:
        return setting(str(operands["i"]), middle) + _buffer(str(operands["i"])[1], chance)
    if does in {"push", "pop", "push_multiple", "pop_multiple", "link"}:
        return setting("SP", middle)
    if does == "unlink":
        return setting("FP", middle)
    if does == "shift_by_register":
        return setting(str(operands["s"]), chance.randrange(40))
    if does.startswith("modify_index") and chance.random() < 0.5:
        return setting(str(operands["i"]), middle) + _buffer(str(operands["i"])[1], chance)
    named = [each for each in operands.values() if each in ENCODED[:32]]
    return setting(str(chance.choice(named)), word(chance)) if named and chance.random() < 0.5 else b""


def _buffer(number: str, chance: random.Random) -> bytes:
    length = chance.choice((0, 0, 4, 16, 256, word(chance)))
    return setting(f"B{number}", MEMORY) + setting(f"L{number}", length)


def start(chance: random.Random) -> bytes:
    """Return the code that fills the memory and the registers, and lets CYCLES count."""
    fill = b"".join(
        setting("R0", word(chance)) + encoded(_load_or_store("store"), p=0, d=0)
        for _ in range(MEMORY_BYTES // 4)
    )
    loops = b"".join(setting(each, 0) for each in ("LC0", "LC1"))
    others = b"".join(setting(each, word(chance)) for each in reversed(STARTED) if each[:2] != "LC")
    cycles = setting("SYSCFG", 0x32)
    return setting("P0", MEMORY) + fill + cycles + loops + setting("ASTAT", chance.getrandbits(32)) + others


@cache
def _load_or_store(does: str) -> Form:
    return next(each for each in TABLE if each.does == does and each.given == {"nbytes": 4, "step": 4})


def shown() -> bytes:
    """Return the code that has the simulator print all that is compared, and stop."""
    debug = the("debug")
    registers = b"".join(encoded(debug, g=ENCODED.index(each)) for each in SHOWN)
    memory = (encoded(_load_or_store("load"), p=0, d=0) + encoded(debug, g=0)) * (MEMORY_BYTES // 4)
    return registers + setting("P0", MEMORY) + memory + encoded(the("halt"))


def simulated(code: bytes, folder: Path) -> Outcome:
    """Run code under the GNU simulator."""
    code += shown()
    program = folder / "program"
    octets = _template(folder)
    at = octets.index(b"\xde\xc0\xad\x0b" * 4)
    program.write_bytes(octets[:at] + code + octets[at + len(code) :])
    said = subprocess.run(
        ["bfin-elf-run", str(program)], capture_output=True, text=True, check=False, timeout=60
    ).stdout
    values = [(name, int(value, 16)) for name, value in re.findall(r"DBG : (\S+) = 0x([0-9a-f]+)", said)]
    if len(values) != len(SHOWN) + MEMORY_BYTES // 4:
        raise SystemExit(f"the simulator must print every register, but says: {said[-400:]}")
    memory = b"".join(value.to_bytes(4, "little") for _, value in values[len(SHOWN) :])
    return Outcome(dict(values[: len(SHOWN)]), memory)


@cache
def _template(folder: Path) -> bytes:
    """Return a program with room for code."""
    source, made, program = folder / "room.s", folder / "room.o", folder / "room"
    source.write_text(f".global __start\n__start:\n.fill {ROOM_BYTES // 4}, 4, 0x0badc0de\n")
    subprocess.run(["bfin-elf-as", str(source), "-o", str(made)], check=True)
    subprocess.run(["bfin-elf-ld", f"-Ttext={CODE:#x}", str(made), "-o", str(program)], check=True)
    return program.read_bytes()


def translated(code: bytes) -> Outcome:
    """Run code as native code."""
    code += encoded(the("halt"))
    space = AddressSpace()
    octets = space.add(0, MEMORY + ROOM_BYTES).octets
    octets[CODE : CODE + len(code)] = np.frombuffer(code, np.uint8)
    core = Processor(space)
    core.state["PC"] = CODE
    core.run()
    core.state["CLOCK"] -= 1  # HLT, where the simulator prints
    memory = octets[MEMORY : MEMORY + MEMORY_BYTES].tobytes()
    return Outcome({each: core.state[each] & 0xFFFFFFFF for each in SHOWN}, memory)


def differences(steps: Sequence[Step], beginning: bytes, folder: Path) -> list[str]:
    """Run a sequence both ways; return what differs."""
    code = beginning + b"".join(each.before + each.code for each in steps)
    there, here = simulated(code, folder), translated(code)
    found = [
        f"{name}: {value:#010x} in the simulator, {here.registers[name]:#010x} translated"
        for name, value in there.registers.items()
        if value != here.registers[name]
    ]
    return [*found, *(["memory"] if there.memory != here.memory else [])]


def shortest(steps: Sequence[Step], beginning: bytes, folder: Path) -> Sequence[Step]:
    """Leave out steps as long as there is a difference."""
    size = len(steps) // 2
    while size:
        for first in range(0, len(steps), size):
            fewer = [*steps[:first], *steps[first + size :]]
            if fewer and differences(fewer, beginning, folder):
                return shortest(fewer, beginning, folder)
        size //= 2
    return steps


def sequence(forms: Sequence[Form], length: int, chance: random.Random) -> list[Step]:
    """Return so many random instructions of `forms`."""
    found: list[Step] = []
    while len(found) < length:
        if (each := step(chance.choice(forms), chance)) is not None:
            found.append(each)
    return found


def main() -> None:
    """Compare sequences until one differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sequences", nargs="?", type=int, default=20)
    parser.add_argument("--length", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--does")
    parser.add_argument("--record", type=Path)
    given = parser.parse_args()
    forms = [
        each
        for each in TABLE
        if each.does not in LEFT_OUT and each.beside is not Beside.DSP and given.does in {None, each.does}
    ]
    recorded = []
    with tempfile.TemporaryDirectory() as name:
        for number in range(given.sequences):
            chance = random.Random(given.seed * 1_000_000 + number)
            beginning, steps = start(chance), sequence(forms, given.length, chance)
            if differences(steps, beginning, Path(name)):
                few = shortest(steps, beginning, Path(name))
                lines = [*map(str, few), *differences(few, beginning, Path(name))]
                raise SystemExit("\n".join([f"sequence {number} of seed {given.seed} differs:", *lines]))
            recorded.append(beginning + b"".join(each.before + each.code for each in steps))
        if given.record:
            programs = [_program(each, Path(name)) for each in PROGRAMS.values()]
            rows = [json.dumps(_row(each, Path(name))) for each in (*programs, *recorded)]
            given.record.write_text("[\n" + ",\n".join(rows) + "\n]\n")
    print(f"{given.sequences} sequences of {given.length} instructions of {len(forms)} forms: no difference")


def _program(program: str, folder: Path) -> bytes:
    """Return a program of control flow, behind what it expects to find."""
    before = setting("SYSCFG", 0x32) + setting("SP", MEMORY + MEMORY_BYTES) + setting("R0", 0)
    return before + assembled(program, folder, CODE + len(before))


def _row(code: bytes, folder: Path) -> dict[str, object]:
    """Return code with what the simulator leaves behind it: registers that are not 0, and the memory."""
    there = simulated(code, folder)
    registers = {name: value for name, value in there.registers.items() if value}
    return {"code": code.hex(), "registers": registers, "memory": there.memory.rstrip(b"\0").hex()}


if __name__ == "__main__":
    main()
