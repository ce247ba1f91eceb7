"""The shipped boards: numbers that fit each other, and errors that name what there is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.bf561 import BF561
from bfsim.chip.boards import BOARDS, board_named
from bfsim.chip.memory_map import MIB, Region
from bfsim.chip.sensor_spec import CameraSpec
from bfsim.chip.sensors import MHZ, OV9650
from bfsim.chip.spec import BoardSpec, Pll
from bfsim.errors import ConfigError

each_board = pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))


def numbers_of(record: object, path: str = "") -> Iterator[tuple[str, Fraction]]:
    """Every number in a tree of dataclasses and tuples, with its path.

    Addresses of memories are left out, and what is a camera's own: a deviation may be negative.
    """
    if is_dataclass(record) and not isinstance(record, Region | CameraSpec):
        for field in fields(record):
            yield from numbers_of(getattr(record, field.name), f"{path}.{field.name}")
    elif isinstance(record, tuple):
        for number, each in enumerate(record):
            yield from numbers_of(each, f"{path}[{number}]")
    elif isinstance(record, int | Fraction) and not isinstance(record, bool):
        yield path, Fraction(record)


def test_unknown_board_is_told_the_known_ones() -> None:
    """A slip in the name must not send anyone to the documentation."""
    with pytest.raises(
        ConfigError, match="must be one of cm-bf561, cm-bf561-ratings, .*, cm-bf533, not 'cm-bf562'"
    ):
        board_named("cm-bf562")


@pytest.mark.parametrize("name", BOARDS)
def test_boards_are_found_by_their_own_name(name: str) -> None:
    """The key is the name that the reports print."""
    assert board_named(name).name == name


ZERO_MEANS_OFF = {".deb_period_transfers", ".mdma_period_transfers", ".chip.dma.imdma_word_cclk"}


@each_board
def test_every_number_is_positive(board: BoardSpec) -> None:
    """No latency, rate or size of a real part is zero or less; where a rule or a block is off the docstring says so."""
    numbers = dict(numbers_of(board))
    assert len(numbers) > 20
    assert {path for path, number in numbers.items() if number <= 0} <= ZERO_MEANS_OFF


@each_board
def test_sdram_banks_fill_the_sdram(board: BoardSpec) -> None:
    """Every address of the SDRAM is in one of its banks, and page and bank number are bits of it."""
    sdram = board.sdram
    (region,) = [each for each in board.chip.regions if each.memory == "SDRAM"]
    assert sdram.banks * sdram.bank_bytes == sdram.nbytes == region.nbytes
    for size in (sdram.page_bytes, sdram.bank_bytes):
        assert size.bit_count() == 1
    assert sdram.miss_sclk < sdram.conflict_sclk


WORKED_OUT = [
    ("cm-bf561", 600 * MHZ, 120 * MHZ, 1866, 32),
    ("cm-bf561-ratings", 600 * MHZ, Fraction(400 * MHZ, 3), 2074, 32),
    ("cm-bf561-525-131", 525 * MHZ, Fraction(525 * MHZ, 4), 2041, 32),
    ("cm-bf561-500-125", 500 * MHZ, 125 * MHZ, 1944, 32),
    ("cm-bf561-550-110", 550 * MHZ, 110 * MHZ, 1709, 64),
    ("cm-bf561-500-100", 500 * MHZ, 100 * MHZ, 1553, 64),
    ("bf561-ezkit", 600 * MHZ, 120 * MHZ, 928, 64),
    ("cm-bf533", 550 * MHZ, 110 * MHZ, 850, 32),
]
"""Name, CCLK, SCLK, EBIU_SDRRC by u-boot's formula, MB of SDRAM."""


@pytest.mark.parametrize(("name", "cclk_hz", "sclk_hz", "sdrrc", "megabytes"), WORKED_OUT)
def test_clocks_refresh_and_size_of_every_board(
    name: str, cclk_hz: int, sclk_hz: Fraction | int, sdrrc: int, megabytes: int
) -> None:
    """CLKIN times multiplier over dividers; and EBIU_SDRRC of u-boot, the interval less tRAS and tRP."""
    board = BOARDS[name]
    assert (board.clocks.cclk_hz, board.clocks.sclk_hz) == (cclk_hz, sclk_hz)
    interval_sclk = board.sdram.refresh_interval_sclk(board.clocks.sclk_hz)
    assert interval_sclk - board.sdram.nRAS - board.sdram.nRP == sdrrc
    assert board.sdram.nbytes == megabytes * MIB


def test_every_board_is_in_the_tests() -> None:
    """A board that nobody worked out by hand is not shipped."""
    assert [name for name, *_ in WORKED_OUT] == list(BOARDS)


def test_the_refresh_word_of_the_ez_kit() -> None:
    """Its boot code writes 0x3A9: 120 MHz x 64 ms over 8192 rows, without taking tRAS and tRP from it."""
    assert BOARDS["bf561-ezkit"].sdram.refresh_interval_sclk(Fraction(120 * MHZ)) == 0x3A9


@pytest.mark.parametrize(
    ("name", "refresh_sclk", "interval_sclk"),
    [("cm-bf561", 2 + 7 + 2, 1875), ("bf561-ezkit", 3 + 6 + 3, 937), ("cm-bf533", 2 + 7 + 2, 859)],
)
def test_refresh_share(name: str, refresh_sclk: int, interval_sclk: int) -> None:
    """Refresh takes 0.6 % of the CM-BF561's bus, and about twice as much where there are twice as many rows."""
    board = BOARDS[name]
    share = Fraction(board.sdram.refresh_sclk, board.sdram.refresh_interval_sclk(board.clocks.sclk_hz))
    assert share == Fraction(refresh_sclk, interval_sclk)
    assert float(share) == pytest.approx(0.006 * board.sdram.rows_refreshed / 4096, rel=0.1)


@each_board
def test_clocks_are_the_plls_and_keep_the_ratings(board: BoardSpec) -> None:
    """A board runs as its PLL is set and within its chip's ratings; one is the pair of ratings itself."""
    if board.pll:
        assert board.clocks == board.chip.clocks_of(board.pll)
    else:
        assert board.name == "cm-bf561-ratings"
        assert board.clocks.cclk_hz == board.chip.max_vco_hz
        assert board.clocks.sclk_hz == board.chip.max_sclk_hz


@pytest.mark.parametrize(
    ("multiplier", "ssel", "problem"),
    [
        (24, 4, r"SCLK .* at most 133,333,333 Hz, not 150,000,000 Hz \(CLKIN x 24, csel 1, ssel 4\)"),
        (25, 5, "VCO of an ADSP-BF561 must be at most 600,000,000 Hz, not 625,000,000 Hz"),
    ],
)
def test_a_pll_beyond_the_ratings_is_refused(multiplier: int, ssel: int, problem: str) -> None:
    """Why 600 MHz and 133 MHz cannot be had together: the next smaller divider makes 150 MHz."""
    pll = Pll(clkin_hz=Fraction(25 * MHZ), vco_multiplier=multiplier, csel=1, ssel=ssel)
    with pytest.raises(ConfigError, match=problem):
        BF561.clocks_of(pll)


@pytest.mark.parametrize(
    ("field", "value", "problem"),
    [
        ("vco_multiplier", 65, "vco_multiplier must be 1 to 64, not 65"),
        ("csel", 3, "csel must be 1, 2, 4 or 8, not 3"),
        ("ssel", 0, "ssel must be 1 to 15, not 0"),
        ("ssel", 16, "ssel must be 1 to 15, not 16"),
    ],
)
def test_a_pll_that_the_registers_cannot_hold_is_refused(field: str, value: int, problem: str) -> None:
    """PLL_CTL and PLL_DIV have few bits."""
    pll = Pll(clkin_hz=Fraction(25 * MHZ), vco_multiplier=20, csel=1, ssel=5)
    with pytest.raises(ConfigError, match=problem):
        replace(pll, **{field: value})


@given(st.integers(1, 64), st.sampled_from([1, 2, 4, 8]), st.integers(1, 15))
def test_clocks_of_any_pll(multiplier: int, csel: int, ssel: int) -> None:
    """Whatever is not refused is within the ratings and divides the VCO exactly."""
    pll = Pll(clkin_hz=Fraction(25 * MHZ), vco_multiplier=multiplier, csel=csel, ssel=ssel)
    try:
        clocks = BF561.clocks_of(pll)
    except ConfigError:
        assert 25 * multiplier > 600 or Fraction(25 * multiplier, ssel) > Fraction(400, 3)
    else:
        assert clocks.cclk_hz * csel == clocks.sclk_hz * ssel == pll.vco_hz <= BF561.max_vco_hz
        assert clocks.sclk_hz <= BF561.max_sclk_hz


@each_board
def test_there_is_a_ppi_for_each_camera(board: BoardSpec) -> None:
    """The left camera is on PPI0; a chip with one PPI sees with one eye."""
    assert tuple(each.name for each in board.cameras) == ("left", "right")[: board.chip.ppis]
    for number in range(board.chip.ppis):
        assert f"PPI{number}_DMA" in board.chip.interrupts.__members__
    assert f"PPI{board.chip.ppis}_DMA" not in board.chip.interrupts.__members__


@each_board
def test_caches_are_as_large_as_what_can_be_cache(board: BoardSpec) -> None:
    """Caches and memory map agree, and a cache has whole sets."""
    cache = board.chip.cache
    for region in board.chip.regions:
        if region.memory.startswith("L1_DATA"):
            assert region.cache_nbytes == cache.data_bytes_per_bank
        elif region.memory == "L1_CODE_CACHE":
            assert region.cache_nbytes == region.nbytes == cache.code_bytes
    assert cache.data_bytes_per_bank % (cache.data_ways * cache.line_bytes) == 0
    assert cache.code_bytes % (cache.code_ways * cache.line_bytes) == 0


@each_board
def test_blocks_of_the_chip_agree(board: BoardSpec) -> None:
    """L2 is in the memory map if it has a latency, every core owns memory, and DMA fits interrupts and SDRAM."""
    chip = board.chip
    assert (chip.l2 is not None) == any(region.memory == "L2" for region in chip.regions)
    assert {region.owner for region in chip.regions} == {*chip.cores, "shared"}
    assert sum(name.startswith("MDMA") for name in chip.interrupts.__members__) == chip.dma.mdma_streams
    assert bool(chip.dma.imdma_word_cclk) == ("IMDMA_0" in chip.interrupts.__members__)
    assert chip.dma.word_bytes == board.sdram.word_bytes


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
