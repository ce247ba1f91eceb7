"""Time in whole numbers: ticks, clocks whose cycles are multiples of a tick, and other clocks.

A tick is the longest time of which both a CCLK and an SCLK cycle are whole multiples, so nothing is rounded
between core and bus. PPI_CLK and recorded time stamps are asynchronous. `PeriodicEdges` and
`Clocks.ticks_of_ns` convert them exactly, as fractions, and round once per edge.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm

from bfsim.errors import ConfigError, shown, with_article


@dataclass(frozen=True, slots=True)
class Clocks:
    """The two synchronous clocks of the chip, in Hz, as exact fractions (133⅓ MHz is 400_000_000 / 3).

    `tick_hz` is the least common multiple of both; `cclk_ticks` and `sclk_ticks` are the ticks of one cycle.
    """

    cclk_hz: Fraction
    sclk_hz: Fraction
    tick_hz: Fraction = field(init=False)
    cclk_ticks: int = field(init=False)
    sclk_ticks: int = field(init=False)

    def __post_init__(self) -> None:
        for name, hz in (("cclk_hz", self.cclk_hz), ("sclk_hz", self.sclk_hz)):
            if not isinstance(hz, int | Fraction):
                raise ConfigError(
                    f"clocks.{name} must be of the type Fraction, such as Fraction({shown(hz)}), "
                    f"not {shown(hz)}, {with_article(type(hz).__name__)}"
                )
        if min(self.cclk_hz, self.sclk_hz) <= 0:
            raise ConfigError(
                f"a clock must be faster than 0 Hz, not {float(min(self.cclk_hz, self.sclk_hz)):g} Hz"
            )
        common = lcm(self.cclk_hz.denominator, self.sclk_hz.denominator)
        tick_hz = Fraction(lcm(int(self.cclk_hz * common), int(self.sclk_hz * common)), common)
        object.__setattr__(self, "tick_hz", tick_hz)
        object.__setattr__(self, "cclk_ticks", int(tick_hz / self.cclk_hz))
        object.__setattr__(self, "sclk_ticks", int(tick_hz / self.sclk_hz))

    def ticks_of_ns(self, time_ns: int) -> int:
        """Return the first tick at or after `time_ns`."""
        return -int(-(time_ns * self.tick_hz) // 1_000_000_000)

    def ns_of_ticks(self, ticks: int) -> int:
        """Return the last whole nanosecond at or before a tick."""
        return int(ticks * 1_000_000_000 // self.tick_hz)


@dataclass(frozen=True, slots=True)
class PeriodicEdges:
    """Edges of an asynchronous clock: edge n is at offset + n · period, rounded up to a tick, without drift."""

    period_ticks: Fraction
    offset_ticks: Fraction = Fraction(0)

    @classmethod
    def of(cls, clocks: Clocks, hz: Fraction, offset_cycles: Fraction = Fraction(0)) -> PeriodicEdges:
        """Return the edges of a clock of `hz`, one per cycle, the first one after `offset_cycles` of its cycles."""
        cycle_ticks = clocks.tick_hz / hz
        return cls(cycle_ticks, cycle_ticks * offset_cycles)

    def after(self, count: int) -> int:
        """Return the ticks from the start to edge `count`."""
        return -int(-(self.offset_ticks + count * self.period_ticks) // 1)
