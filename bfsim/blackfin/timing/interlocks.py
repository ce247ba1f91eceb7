"""Interlocks: an instruction waits until a register that it reads is ready.

Each cycle in between hides one of the wait, whether an instruction is issued in it, another one waits, or the code is
fetched anew after a jump. An instruction in between hides one however many cycles it takes, according to VisualDSP++'s
notes [VANN].
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache

from bfsim.blackfin.instructions.decode import Instruction
from bfsim.blackfin.instructions.dependences import Registers, registers_of
from bfsim.blackfin.timing.tables import Interlock

PARTLY = {"set_low", "set_high"}
"""These leave the other half of a register as it is, but wait for nothing."""


@dataclass(frozen=True, slots=True)
class Waiting:
    """How long the next instruction would have to wait for registers, by interlock."""

    cclk: Mapping[tuple[str, Interlock], int]

    def later(self, cclk: int) -> Waiting:
        """Return the waits some cycles later."""
        return Waiting({key: left - cclk for key, left in self.cclk.items() if left > cclk})

    def worst(self, other: Waiting) -> Waiting:
        """Return the longer waits of two."""
        keys = self.cclk.keys() | other.cclk.keys()
        return Waiting({key: max(self.cclk.get(key, 0), other.cclk.get(key, 0)) for key in keys})


NOTHING = Waiting({})


@dataclass(frozen=True, slots=True)
class Wait:
    """How long an instruction waits, and for which register; for none, an empty name."""

    cclk: int = 0
    register: str = ""


NO_WAIT = Wait()


def made_by(interlock: Interlock, writer: Registers) -> frozenset[str]:
    """Return the registers of an interlock that are not ready right after an instruction."""
    if (interlock.by and interlock.by.isdisjoint(writer.does)) or (
        interlock.moved_from and interlock.moved_from.isdisjoint(writer.reads)
    ):
        return frozenset()
    return interlock.registers & (writer.loaded if interlock.loaded else writer.writes)


def holds(interlock: Interlock, reader: Registers) -> bool:
    """Whether an instruction that reads a register of an interlock waits for it."""
    return reader.does.isdisjoint(PARTLY) and (
        not interlock.used_by or not interlock.used_by.isdisjoint(reader.does)
    )


@cache
def _made(writer: Registers, interlocks: tuple[Interlock, ...]) -> Waiting:
    """Return the waits that an instruction causes after it: few cause any."""
    return Waiting({(register, each): each.cclk for each in interlocks for register in made_by(each, writer)})


def issued(
    instruction: Instruction, before: Waiting, interlocks: tuple[Interlock, ...]
) -> tuple[Wait, Waiting]:
    """Return how long an instruction waits, and the waits left after it."""
    found = registers_of(instruction)
    made = _made(found, interlocks)
    if not before.cclk:
        return NO_WAIT, made
    waits = [
        Wait(left, register)
        for (register, each), left in before.cclk.items()
        if register in found.reads and holds(each, found)
    ]
    wait = max(waits, key=lambda each: (each.cclk, each.register), default=NO_WAIT)
    left = {key: cclk for key, cclk in before.later(wait.cclk + 1).cclk.items() if key[0] not in found.writes}
    return wait, Waiting({**left, **made.cclk})


def issued_in_turn(
    instructions: Iterable[Instruction], before: Waiting, interlocks: tuple[Interlock, ...]
) -> tuple[tuple[Wait, ...], Waiting]:
    """Return how long each instruction of a sequence waits, and the waits left after the last one."""
    waits = []
    for each in instructions:
        wait, before = issued(each, before, interlocks)
        waits.append(wait)
    return tuple(waits), before
