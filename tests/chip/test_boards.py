"""The shipped boards: numbers that fit each other, and errors that name what there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from fractions import Fraction

import pytest

from bfsim.chip.boards import BOARDS, board_named
from bfsim.chip.memory_map import Region
from bfsim.chip.sensors import OV9650
from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError

each_board = pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))


def numbers_of(record: object, path: str = "") -> Iterator[tuple[str, Fraction]]:
    """Every number in a tree of dataclasses and tuples, with its path. Addresses of memories are left out."""
    if is_dataclass(record) and not isinstance(record, Region):
        for field in fields(record):
            yield from numbers_of(getattr(record, field.name), f"{path}.{field.name}")
    elif isinstance(record, tuple):
        for number, each in enumerate(record):
            yield from numbers_of(each, f"{path}[{number}]")
    elif isinstance(record, int | Fraction):
        yield path, Fraction(record)


def test_unknown_board_is_told_the_known_ones() -> None:
    """A slip in the name must not send anyone to the documentation."""
    with pytest.raises(ConfigError, match="must be one of cm-bf561, cm-bf561-ratings, not 'cm-bf562'"):
        board_named("cm-bf562")


@pytest.mark.parametrize("name", BOARDS)
def test_boards_are_found_by_their_own_name(name: str) -> None:
    """The key is the name that the reports print."""
    assert board_named(name).name == name


@each_board
def test_every_number_is_positive(board: BoardSpec) -> None:
    """No latency, rate or size of a real part is zero or less."""
    numbers = dict(numbers_of(board))
    assert len(numbers) > 20
    assert [path for path, number in numbers.items() if number <= 0] == []


@each_board
def test_sdram_banks_fill_the_sdram(board: BoardSpec) -> None:
    """Every address of the SDRAM is in one of its banks, and page and bank number are bits of it."""
    sdram = board.sdram
    (region,) = [each for each in board.chip.regions if each.memory == "SDRAM"]
    assert sdram.banks * sdram.bank_bytes == region.nbytes
    for size in (sdram.page_bytes, sdram.bank_bytes):
        assert size.bit_count() == 1
    assert sdram.miss_sclk < sdram.conflict_sclk


@each_board
def test_clocks_keep_their_ratings(board: BoardSpec) -> None:
    """600 MHz and 133 1/3 MHz are the most that the parts are rated for."""
    assert board.clocks.cclk_hz <= 600_000_000
    assert board.clocks.sclk_hz <= Fraction(400_000_000, 3)


@pytest.mark.parametrize(("width", "height", "frames_hz"), [(640, 480, 30), (320, 240, 60), (160, 120, 60)])
def test_sensor_keeps_the_frame_rates_of_its_guide(width: int, height: int, frames_hz: int) -> None:
    """PPI_CLK over line clocks and lines is the rate that the sensor's documents state."""
    mode = OV9650.mode(width, height)
    assert mode.ppi_clk_hz / (mode.line_clocks * mode.frame_lines) == frames_hz


@pytest.mark.parametrize(("width", "height"), [(2, 1), (16, 8), (64, 48), (322, 240), (1280, 1024)])
def test_foreign_sizes_come_at_the_rate_of_the_largest_mode(width: int, height: int) -> None:
    """A picture of another camera has room for its pixels and lines, and comes 30 times a second."""
    mode = OV9650.mode(width, height)
    assert (mode.width_px, mode.height_px) == (width, height)
    assert mode.line_clocks >= 2 * width
    assert mode.frame_lines >= height
    assert mode.ppi_clk_hz / (mode.line_clocks * mode.frame_lines) == 30
