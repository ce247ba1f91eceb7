"""Oscillators of cameras: exact for hours, apart by their ppm, and a beat between their frames."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import ceil

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import BOARDS, CM_BF561
from bfsim.chip.sensors import LEFT_CAMERA, OV9650, RIGHT_CAMERA
from bfsim.machine.cameras.oscillator import Oscillator

CLOCKS = CM_BF561.clocks
TICK_HZ = CLOCKS.tick_hz
VGA, QVGA = OV9650.mode(640, 480), OV9650.mode(320, 240)
PPM = st.fractions(-200, 200, max_denominator=1000)
PHASE = st.fractions(0, 1, max_denominator=10**6)


def oscillator(ppm: float = 0, phase: Fraction = Fraction(0)) -> Oscillator:
    """Return a QVGA camera at 60 Hz whose quartz is `ppm` off."""
    return Oscillator(CLOCKS, QVGA, replace(LEFT_CAMERA, offset_ppm=Fraction(ppm), phase_frames=phase))


def test_frames_and_lines_of_a_perfect_oscillator() -> None:
    """At 600 MHz a QVGA frame is 10 million ticks, a line 40 000, of which 32 000 have pixels, 50 a cycle."""
    perfect = oscillator()
    assert [perfect.frames.after(number) for number in range(3)] == [0, 10_000_000, 20_000_000]
    first = QVGA.lines_before * 40_000
    assert [perfect.line_start(0, line) for line in (0, 1, 239)] == [
        first,
        first + 40_000,
        first + 239 * 40_000,
    ]
    assert perfect.line_end(0, 0) == first + 32_000
    assert perfect.line_end(1, 239) == 10_000_000 + first + 239 * 40_000 + 32_000


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("camera", [LEFT_CAMERA, RIGHT_CAMERA], ids=lambda each: each.name)
def test_the_lines_of_a_frame_lie_inside_it(board: str, camera: object) -> None:
    """Sync, picture, blanking, next sync: in this order on every board."""
    each = Oscillator(BOARDS[board].clocks, VGA, camera)
    for frame in (0, 1, 107_999):
        starts = [each.line_start(frame, line) for line in range(VGA.height_px)]
        ends = [each.line_end(frame, line) for line in range(VGA.height_px)]
        edges = [each.frames.after(frame)]
        for start, end in zip(starts, ends, strict=True):
            edges += [start, end]
        edges.append(each.frames.after(frame + 1))
        assert edges == sorted(set(edges))


def test_an_hour_apart() -> None:
    """After an hour of frames two oscillators 50 ppm apart are 0.18 s apart, exactly 3600 s x (1 - 1 / 1.00005)."""
    slow, fast, frames = oscillator(ppm=0), oscillator(ppm=50), 60 * 3600
    apart = slow.frames.after(frames) - fast.frames.after(frames)
    assert apart == int(3600 * TICK_HZ * (1 - 1 / (1 + Fraction(50, 10**6))))
    assert float(apart / TICK_HZ) == pytest.approx(0.18, rel=1e-4)


def test_frames_beat() -> None:
    """60 ppm apart at 60 Hz: once in 1 / 0.0036 Hz, 277.8 s, the faster camera has made one frame more."""
    slow, fast = oscillator(ppm=-30), oscillator(ppm=30)
    beat_s = 1 / (Fraction(60) * 60 / 10**6)
    assert float(beat_s) == pytest.approx(277.8, abs=0.1)
    slow_frames = 60 * (1 - Fraction(30, 10**6)) * beat_s
    assert slow.frames.period_ticks * slow_frames == fast.frames.period_ticks * (slow_frames + 1)


def test_the_shipped_cameras_are_unlocked() -> None:
    """A third of a frame apart at the start; a quarter of an hour later it is another part of it."""
    left, right = (Oscillator(CLOCKS, QVGA, each) for each in (LEFT_CAMERA, RIGHT_CAMERA))
    at_start = right.frames.after(0) - left.frames.after(0)
    assert at_start == ceil(right.frames.period_ticks / 3)
    assert right.frames.after(54_000) - left.frames.after(54_000) - at_start == pytest.approx(
        54_000 * 10_000_000 * 60e-6, rel=1e-3
    )


@given(PPM, PHASE, st.integers(0, 10**8), st.integers(0, QVGA.height_px - 1))
def test_no_edge_is_a_tick_late(ppm: Fraction, phase: Fraction, frame: int, line: int) -> None:
    """Weeks of frames on, each edge is the first tick at or after its exact time."""
    each = Oscillator(CLOCKS, QVGA, replace(LEFT_CAMERA, offset_ppm=ppm, phase_frames=phase))
    frame_ticks = TICK_HZ / (60 * (1 + ppm / 10**6))
    sync = (frame + phase) * frame_ticks
    start = sync + (QVGA.lines_before + line) * frame_ticks / QVGA.frame_lines
    assert each.frames.after(frame) == ceil(sync)
    assert each.line_start(frame, line) == ceil(start)
    assert each.ppi_clk_hz == 12_000_000 * (1 + ppm / 10**6)
