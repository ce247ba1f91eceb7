"""The system, as far as a single core without interrupts has one, and what simulators add."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.event import Event


def nothing(fx: Effects) -> None:
    """Caches and pipelines are not simulated here either."""


core_synchronise = system_synchronise = nothing


def cache(fx: Effects, p: str, step: int = 0) -> None:
    """Caches hold nothing that memory does not; the pointer steps on by a cache line."""
    fx.write(p, fx.read(p) + step)


def test_and_set(fx: Effects, p: str) -> None:
    address = fx.read(p)
    old = fx.load(address, 1)
    fx.write("CC", old.equals(0))
    fx.store(address, old | 0x80)


def system(fx: Effects, **_: str) -> None:
    """Leave: there is no event controller."""
    fx.leave(Event.SYSTEM)


return_from_interrupt = return_from_exception = return_from_nmi = return_from_emulation = system
idle = emulation_exception = debug = raise_interrupt = disable_interrupts = enable_interrupts = system


def exception(fx: Effects, n: int) -> None:
    fx.leave(Event.EXCEPTION, fx.constant(n))


def output(fx: Effects, c: int) -> None:
    fx.leave(Event.OUTPUT, fx.constant(c))


def output_register(fx: Effects, d: str) -> None:
    fx.leave(Event.OUTPUT, fx.read(d).low(8))


def halt(fx: Effects) -> None:
    fx.leave(Event.HALT)


def abort(fx: Effects) -> None:
    fx.leave(Event.ABORT)


def assert_low(fx: Effects, g: str, n: int) -> None:
    actual = fx.low(g)
    fx.leave(Event.ASSERTION, actual, condition=actual.differs(n))


def assert_high(fx: Effects, g: str, n: int) -> None:
    actual = fx.high(g)
    fx.leave(Event.ASSERTION, actual, condition=actual.differs(n))
