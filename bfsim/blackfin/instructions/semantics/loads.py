"""Loads and stores through pointers; a pointer steps on after the access."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.semantics.results import write_half


def load(
    fx: Effects, d: str, p: str, nbytes: int, n: int = 0, signed: int = 0, step: int = 0, i: str | None = None
) -> None:
    loaded = fx.load(fx.read(p) + n, nbytes)
    fx.write(d, loaded.sign_extended() if signed else loaded.zero_extended())
    _step(fx, p, step, i)


def store(fx: Effects, d: str, p: str, nbytes: int, n: int = 0, step: int = 0, i: str | None = None) -> None:
    fx.store(fx.read(p) + n, fx.read(d).low(8 * nbytes))
    _step(fx, p, step, i)


def load_half(fx: Effects, d: str, p: str, half: str, i: str | None = None) -> None:
    write_half(fx, d, half == "high", fx.load(fx.read(p), 2))
    _step(fx, p, 0, i)


def store_half(fx: Effects, d: str, p: str, half: str, i: str | None = None) -> None:
    fx.store(fx.read(p), fx.low(d) if half == "low" else fx.high(d))
    _step(fx, p, 0, i)


def _step(fx: Effects, pointer: str, step: int, index: str | None) -> None:
    if step:
        fx.write(pointer, fx.read(pointer) + step)
    elif index not in {None, pointer}:
        fx.write(pointer, fx.read(pointer) + fx.read(index))
