"""Constants into registers."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.arithmetic import add_with_flags


def set_register(fx: Effects, d: str, i: int) -> None:
    fx.write(d, i)


def set_low(fx: Effects, d: str, i: int) -> None:
    fx.write_low(d, fx.constant(i, 16))


def set_high(fx: Effects, d: str, i: int) -> None:
    fx.write_high(d, fx.constant(i, 16))


def add_immediate(fx: Effects, d: str, i: int) -> None:
    fx.write(d, add_with_flags(fx, fx.read(d), fx.constant(i)))


def add_immediate_pointer(fx: Effects, d: str, i: int) -> None:
    fx.write(d, fx.read(d) + i)
