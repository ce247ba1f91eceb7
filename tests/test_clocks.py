"""Ticks: both synchronous clocks in whole numbers of them, asynchronous ones rounded up once per edge."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, gcd
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.clocks import Clocks, PeriodicEdges
from bfsim.errors import ConfigError

MHZ = 1_000_000
RATES_HZ = st.fractions(min_value=1, max_value=10**9, max_denominator=1000)


@pytest.mark.parametrize(
    ("sclk_hz", "tick_hz", "cclk_ticks", "sclk_ticks"),
    [
        (Fraction(120 * MHZ), 600 * MHZ, 1, 5),  # SCLK divides CCLK: a tick is a CCLK cycle
        (Fraction(400 * MHZ, 3), 1200 * MHZ, 2, 9),  # 133 1/3 MHz: 4.5 CCLK cycles, so a tick is half of one
        (Fraction(133 * MHZ), 79_800 * MHZ, 133, 600),
    ],
)
def test_ticks_of_known_clocks(sclk_hz: Fraction, tick_hz: int, cclk_ticks: int, sclk_ticks: int) -> None:
    """Worked out by hand for a CCLK of 600 MHz."""
    clocks = Clocks(Fraction(600 * MHZ), sclk_hz)
    assert (clocks.tick_hz, clocks.cclk_ticks, clocks.sclk_ticks) == (tick_hz, cclk_ticks, sclk_ticks)


@pytest.mark.parametrize("hz", [600e6, "600e6", None])
def test_a_clock_is_exact(hz: Any) -> None:
    """A float was told as an AttributeError of its denominator, in the line 5 of a <string>, when a board's file was read."""
    with pytest.raises(
        ConfigError, match=r"clocks\.sclk_hz must be of the type Fraction, such as Fraction\("
    ):
        Clocks(Fraction(600 * MHZ), hz)


@given(RATES_HZ, RATES_HZ)
def test_tick_is_the_longest_that_divides_both_clocks(cclk_hz: Fraction, sclk_hz: Fraction) -> None:
    """Cycles of both clocks are whole numbers of ticks, and those numbers have no common divisor."""
    clocks = Clocks(cclk_hz, sclk_hz)
    assert clocks.cclk_ticks * cclk_hz == clocks.sclk_ticks * sclk_hz == clocks.tick_hz
    assert gcd(clocks.cclk_ticks, clocks.sclk_ticks) == 1


@pytest.mark.parametrize(("time_ns", "ticks"), [(0, 0), (1, 1), (5, 3), (6, 4), (1_000_000_000, 600_000_000)])
def test_time_stamp_becomes_the_next_tick(time_ns: int, ticks: int) -> None:
    """At 600 MHz 5 ns are three ticks exactly, and 6 ns are rounded up from 3.6."""
    assert Clocks(Fraction(600 * MHZ), Fraction(120 * MHZ)).ticks_of_ns(time_ns) == ticks


@given(st.integers(0, 10**15), RATES_HZ, RATES_HZ)
def test_time_stamp_is_never_early_and_less_than_a_tick_late(
    time_ns: int, cclk_hz: Fraction, sclk_hz: Fraction
) -> None:
    """The conversion is exact, for days of recording as well."""
    clocks = Clocks(cclk_hz, sclk_hz)
    exact = time_ns * clocks.tick_hz / 1_000_000_000
    assert exact <= clocks.ticks_of_ns(time_ns) < exact + 1


@given(st.integers(0, 10**12), RATES_HZ)
def test_edges_never_drift(count: int, hz: Fraction) -> None:
    """Edge n is less than a tick late however many edges were before it: roundings do not add up."""
    clocks = Clocks(Fraction(600 * MHZ), Fraction(120 * MHZ))
    assert PeriodicEdges.of(clocks, hz).after(count) == ceil(count * clocks.tick_hz / hz)


def test_a_thousand_lines_of_a_camera() -> None:
    """800 cycles of 12 MHz are 40 000 ticks of 600 MHz; at 7 MHz a line is no whole number, a thousand are rounded once."""
    clocks = Clocks(Fraction(600 * MHZ), Fraction(120 * MHZ))
    assert PeriodicEdges.of(clocks, Fraction(12 * MHZ, 800)).after(1000) == 40_000_000
    assert PeriodicEdges.of(clocks, Fraction(7 * MHZ, 800)).after(1000) == 68_571_429


def test_edges_start_where_the_offset_says() -> None:
    """A third of a cycle of 1 MHz is 200 ticks of 600 MHz, before the first edge and no other."""
    clocks = Clocks(Fraction(600 * MHZ), Fraction(120 * MHZ))
    edges = PeriodicEdges.of(clocks, Fraction(MHZ), offset_cycles=Fraction(1, 3))
    assert [edges.after(number) for number in range(3)] == [200, 800, 1400]
