"""PPI and camera: lines arrive one by one, each at the end of its time."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np
import pytest

from bfsim.chip.boards import BOARDS
from bfsim.machine.ppi import Ppi
from tests.machine.rig import Bench

HEIGHT, WIDTH = 8, 16


def new_ppi(bench: Bench) -> Ppi:
    """Return a PPI with a camera of 16x8 pixels on it."""
    mode = bench.spec.sensor.mode(WIDTH, HEIGHT)
    return Ppi(bench.env, bench.spec, mode, bench.ebiu, bench.account)


@pytest.mark.parametrize("board", BOARDS)
@pytest.mark.parametrize("start", [0, 12_345])
def test_line_n_is_in_memory_at_the_end_of_its_time(board: str, start: int) -> None:
    """A tick before the closed form the line is not there yet; at that tick it is."""
    bench = Bench(board)
    mode = bench.spec.sensor.mode(WIDTH, HEIGHT)
    line_ticks = mode.line_clocks / mode.ppi_clk_hz * bench.spec.clocks.tick_hz
    picture = np.arange(1, HEIGHT * 2 * WIDTH + 1).astype(np.uint8).reshape(HEIGHT, 2 * WIDTH)
    rows = [bench.row(number * 2048, 2 * WIDTH) for number in range(HEIGHT)]
    for row in rows:
        row.array[:] = 0
    end = new_ppi(bench).receive(picture, rows, start)
    for number, row in enumerate(rows):
        due = start + ceil((number + 1) * line_ticks)
        bench.advance(due - 1)
        assert not row.array.any()
        bench.advance(due)
        assert np.array_equal(row.array, picture[number])
    bench.advance(due + 1)
    assert end.processed


def test_a_picture_is_shorter_than_a_frame_by_the_vertical_blanking() -> None:
    """30 pictures a second, 8 lines of 9 each: the ninth is blank."""
    bench = Bench()
    ppi, mode = new_ppi(bench), bench.spec.sensor.mode(WIDTH, HEIGHT)
    assert mode.frame_lines == 9
    assert ppi.frame_ticks == bench.spec.clocks.tick_hz / 30
    assert ppi.picture_ticks == ceil(Fraction(8, 9) * ppi.frame_ticks)


def test_lines_use_the_bus_and_are_counted() -> None:
    """Every byte of the picture is written once, a word a cycle, with the bank opened once per page."""
    bench = Bench()
    rows = [bench.row(number * 2 * WIDTH, 2 * WIDTH) for number in range(HEIGHT)]
    new_ppi(bench).receive(np.zeros((HEIGHT, 2 * WIDTH), np.uint8), rows, 0)
    bench.advance()
    assert bench.account.written_bytes == HEIGHT * 2 * WIDTH
    assert bench.account.page_misses == 1
    assert bench.account.busy_ticks == bench.sclk(HEIGHT * 2 * WIDTH // 4 + bench.spec.sdram.nRCD)
