"""Boards with other numbers: how paths and values are written, what follows from them, and what no board can have."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip import checks
from bfsim.chip.bf561 import BF561
from bfsim.chip.boards import BOARDS, CM_BF533, CM_BF561, CM_BF561_RATINGS, new_board
from bfsim.chip.checks import require_sound
from bfsim.chip.settings import with_settings
from bfsim.chip.spec import BoardSpec, Pll
from bfsim.errors import ConfigError
from bfsim.fields import leaves
from bfsim.kernel.calls.access_log import OFFSET_MASK
from bfsim.machine.bus import state


def set_to(path: str, value: object, board: BoardSpec = CM_BF561) -> BoardSpec:
    """Return a board with one other number."""
    return with_settings(board, {path: value})[0]


@pytest.mark.parametrize("board", BOARDS.values(), ids=list(BOARDS))
def test_the_shipped_boards_are_sound(board: BoardSpec) -> None:
    """They pass the checks of everyone's boards, and every number may be set to what it is."""
    require_sound(board)
    own = {each.path: each.value for each in leaves(board) if each.is_settable}
    clocks = {path for path in own if path.startswith("clocks.")}
    assert with_settings(board, {path: own[path] for path in own if path not in clocks})[0] == board
    assert with_settings(board, {path: own[path] for path in clocks})[0] == board


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("sdram.nRP", "3", 3),
        ("sdram.nrp", "3", 3),
        ("SDRAM.tRP", " 3 ", 3),
        ("sdram.nRP", 3, 3),
        ("sdram.nRP", 3.0, 3),
        ("sdram.rows_refreshed", "8e3", 8000),
        ("sdram.rows_refreshed", "8_192", 8192),
        ("chip.dma.read_word_sclk", "1.25", Fraction(5, 4)),
        ("chip.dma.read_word_sclk", "5/4", Fraction(5, 4)),
        ("chip.dma.read_word_sclk", Fraction(5, 4), Fraction(5, 4)),
        ("spi_clk_hz", "12.5E6", Fraction(12_500_000)),
        ("chip.max_sclk_hz", "400e6/3", Fraction(400_000_000, 3)),
        ("chip.max_vco_hz", "700,000,000", Fraction(700_000_000)),
        ("cameras.1.offset_ppm", "-30", Fraction(-30)),
        ("chip.regions.11.start", "0x20000000", 0x2000_0000),
        ("dma_over_core", "no", False),
        ("dma_over_core", "TRUE", True),
        ("dma_over_core", False, False),
    ],
)
def test_values_are_of_the_fields_type(path: str, value: object, expected: object) -> None:
    """Exactly as they are written, in Python, too; paths in any case, and a register's field by its own name."""
    board, (name,) = with_settings(CM_BF561, {path: value})
    at = next(each for each in leaves(board) if each.path == name.partition("=")[0])
    assert (at.value, type(at.value)) == (expected, type(expected))


def test_the_clocks_follow_from_the_pll() -> None:
    """25 MHz x 24 / 6; the chip's ratings hold."""
    board = set_to("pll.ssel", 6)
    assert (board.clocks.cclk_hz, board.clocks.sclk_hz) == (600_000_000, 100_000_000)
    with pytest.raises(
        ConfigError, match=r"--set pll.ssel=4: SCLK of an ADSP-BF561 must be at most 133,333,333 Hz"
    ):
        set_to("pll.ssel", 4)
    assert set_to("pll.ssel", 15).clocks.sclk_hz == 40_000_000
    with pytest.raises(ConfigError, match="--set pll.ssel=16: ssel must be 1 to 15, not 16"):
        set_to("pll.ssel", 16)


def test_the_pll_follows_from_the_clocks() -> None:
    """The one setting that makes them of the board's crystal, or none; and what is faster than the chip is refused."""
    board, names = with_settings(CM_BF561, {"clocks.sclk_hz": "125e6", "clocks.cclk_hz": "500e6"})
    assert board.pll == Pll(clkin_hz=Fraction(25_000_000), vco_multiplier=20, csel=1, ssel=4)
    assert names == ("clocks.cclk_hz=500000000", "clocks.sclk_hz=125000000")
    assert (
        set_to("clocks.cclk_hz", "500e6").pll is None
    )  # 500 and 120 MHz have no VCO in common within 15 x 25 x 64
    assert set_to("clocks.cclk_hz", "300e6", set_to("clocks.sclk_hz", "60e6")).pll is not None
    assert set_to("clocks.cclk_hz", 600_000_000).clocks.cclk_hz == 600_000_000
    with pytest.raises(
        ConfigError, match=r"at most 600,000,000, the chip's rating \(chip.max_vco_hz\), not 600,000,001"
    ):
        set_to("clocks.cclk_hz", 600_000_001)
    faster = {"chip.max_vco_hz": "750e6", "clocks.cclk_hz": "750e6"}
    assert with_settings(CM_BF561, faster)[0].clocks.cclk_hz == 750_000_000


@given(st.integers(1, 64), st.sampled_from([1, 2, 4, 8]), st.integers(1, 15))
def test_pll_and_clocks_say_the_same(multiplier: int, csel: int, ssel: int) -> None:
    """Whatever clocks a PLL makes, setting them finds a PLL that makes them."""
    settings = {"pll.vco_multiplier": multiplier, "pll.csel": csel, "pll.ssel": ssel}
    try:
        board, _ = with_settings(CM_BF561, settings)
    except ConfigError:
        return
    clocks = board.clocks
    other, _ = with_settings(CM_BF561, {"clocks.cclk_hz": clocks.cclk_hz, "clocks.sclk_hz": clocks.sclk_hz})
    assert other.clocks == clocks
    assert other.pll
    assert other.chip.clocks_of(other.pll) == clocks


def test_the_memory_map_follows_from_the_sdram() -> None:
    """Banks of twice the size are twice the memory."""
    board = set_to("sdram.bank_bytes", 16 << 20)
    (region,) = [each for each in board.chip.regions if each.memory == "SDRAM"]
    assert region.nbytes == board.sdram.nbytes == 64 << 20


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({"sdram.nRX": 3}, r"--set sdram.nRX=3: there is no 'nRX' \(nearest: .*nRP.*\): sdram has part, nCL, nRCD"),
        ({"sdrm.nRP": 3}, r"there is no 'sdrm' \(nearest: sdram, .*\): the top has name, title, chip, pll"),
        ({"zzzz": 3}, "there is no 'zzzz': the top has name"),
        ({"": 3}, "--set =3: there is no ''"),
        ({"sdram": 3}, "sdram must be followed by one of its fields: part, nCL"),
        ({"cameras": 3}, "cameras must be followed by one of its fields: 0 to 1"),
        ({"cameras.2.offset_ppm": 3}, "there is no '2': cameras has 0 to 1"),
        ({"sdram.nRP.x": 3}, "sdram.nRP is a single value, so that there is nothing below it"),
        ({"sdram.nRP.": 3}, "sdram.nRP is a single value"),
        ({"clocks.tick_hz": 3}, "there is no 'tick_hz' .*: clocks has cclk_hz, sclk_hz$"),
        ({"sdram.__class__": 3}, "there is no '__class__'"),
        ({"name": "mine"}, "name is a name and no number"),
        ({"chip.interrupts": 3}, "chip.interrupts is a name and no number"),
        ({"sdram.nRP": "three"}, "--set sdram.nRP=three: must be a number, .*, not 'three'"),
        ({"sdram.nRP": ""}, "must be a number, .*, not ''"),
        ({"sdram.nRP": 2.5}, "--set sdram.nRP=2.5: must be a whole number, not 2.5"),
        ({"sdram.nRP": True}, "must be a number, .*, not 'True'"),
        ({"sdram.nRP": None}, "must be a number, .*, not 'None'"),
        ({"sdram.nRP": float("nan")}, "must be a number, .*, not 'nan'"),
        ({"spi_clk_hz": "inf"}, "must be a number, .*, not 'inf'"),
        ({"spi_clk_hz": "1e999999999"}, "must be a number"),
        ({"spi_clk_hz": "9" * 5000}, "must be a number"),
        ({"spi_clk_hz": "1/0"}, "must be a number"),
        ({"spi_clk_hz": "1_000_"}, "must be a number"),
        ({"spi_clk_hz": "1,5"}, "must be a number"),
        ({"spi_clk_hz": "٣"}, "must be a number"),
        ({"spi_clk_hz": "__import__('os')"}, "must be a number"),
        ({"dma_over_core": 1}, "--set dma_over_core=1: must be yes or no, not '1'"),
        ({"sdram.nRP": 0}, "--set sdram.nRP=0: sdram.nRP must be 1 to 7, not 0"),
        ({"sdram.nRP": 8}, "sdram.nRP must be 1 to 7, not 8"),
        ({"sdram.nRP": -3}, "sdram.nRP must be 1 to 7, not -3"),
        ({"sdram.nRP": "1e99"}, r"sdram.nRP must be 1 to 7, not 1e\+99"),
        ({"clocks.cclk_hz": 0}, "a clock must be faster than 0 Hz, not 0 Hz"),
        ({"clocks.cclk_hz": "-500e6"}, "a clock must be faster than 0 Hz"),
        ({"pll.clkin_hz": 0}, "a clock must be faster than 0 Hz"),
        ({"clocks.cclk_hz": 599_999_999}, "clocks must have a common multiple"),
        ({"clocks.cclk_hz": "100e6"}, "clocks.sclk_hz must be at most clocks.cclk_hz, 100,000,000"),
        ({"chip.l2.read_cclk": 100_001}, "chip.l2.read_cclk must be 0 to 100,000, not 100,001"),
        ({"sdram.page_bytes": 3000}, "sdram.page_bytes must be a power of two, not 3,000"),
        ({"sdram.banks": 16}, "sdram.banks must be 1 to 8, not 16"),
        ({"sdram.bank_bytes": 64 << 20}, "must, with the chip's L2, have at most 268,435,456 bytes, .*, not 268,566,528"),
        ({"sdram.word_bytes": 2}, "chip.dma.word_bytes must be that of the data bus, sdram.word_bytes 2, not 4"),
        ({"sdram.refresh_ms": 1, "sdram.rows_refreshed": 8192}, "must leave more than 22 SCLK cycles .*, not 14"),
        ({"chip.regions.2.start": 0}, "chip.regions must lie apart, not COREA_L1_DATA_A and SDRAM"),
        ({"chip.regions.15.nbytes": 1024}, "chip.regions must have one SDRAM of 33,554,432 bytes"),
        ({"chip.regions.0.start": 0xFFFF_F000}, "chip.regions.0 must end below 0x100000000"),
        ({"chip.l1.subbank_bytes": 1024}, "must make at most 64 sub-banks"),
        ({"chip.cache.line_bytes": 48}, "chip.cache.line_bytes must be a power of two, not 48"),
        ({"chip.ppis": 1}, "cameras must be one for each of the chip's PPIs, 1"),
        ({"chip.dma.mdma_streams": 3}, "chip.dma.mdma_streams must be 4, as chip.interrupts has them, not 3"),
        ({"chip.dma.imdma_word_cclk": 0}, "chip.dma.imdma_word_cclk must be 1 or more"),
        ({"sensor.modes.0.line_clocks": 1279}, "line_clocks must hold a line's pixels, 1280, not 1279"),
        ({"sensor.modes.0.frame_lines": 480}, "frame_lines must hold the picture, 480 lines"),
        ({"chip.dma.read_word_sclk": "1000001/1000000.1"}, "must be a number"),
        ({"chip.dma.read_word_sclk": "1000002/1000001"}, "must have a denominator of at most 1,000,000"),
        ({"sdram.trp": 3, "sdram.nRP": 4}, "--set sdram.nRP=4: sdram.nRP must be set once, not twice"),
        ({"pll.ssel": 6, "clocks.sclk_hz": "100e6"}, "pll and clocks must not both be set"),
    ],
)  # fmt: skip
def test_what_no_board_can_have_is_refused(settings: dict[str, object], problem: str) -> None:
    """With the setting, what must be and what was."""
    with pytest.raises(ConfigError, match=problem) as caught:
        with_settings(CM_BF561, settings)
    assert str(caught.value).startswith("--set ")
    assert len(str(caught.value)) < 1000


def test_a_part_that_a_board_does_not_have_is_told() -> None:
    """The ratings have no PLL, and the BF533 no L2."""
    with pytest.raises(ConfigError, match="pll is none, so that there is nothing below it"):
        set_to("pll.ssel", 5, CM_BF561_RATINGS)
    with pytest.raises(ConfigError, match="chip.l2 is none, so that there is nothing below it"):
        set_to("chip.l2.read_cclk", 5, CM_BF533)


def test_a_new_boards_pll_is_exact() -> None:
    """Told of its own field, not of the clocks that follow from it."""
    with pytest.raises(
        ConfigError, match=r"pll.clkin_hz must be of the type Fraction, such as Fraction\(25000000.0\)"
    ):
        new_board(
            "x",
            "x",
            BF561,
            Pll(clkin_hz=25e6, vco_multiplier=20, csel=1, ssel=5),
            CM_BF561.sdram,
            dma_over_core=True,
        )  # type: ignore[arg-type]


def test_a_boards_own_fields_are_of_their_types() -> None:
    """A float is not exact; yes is no number; and what is in a tuple is looked at, too."""
    for board, problem in (
        (replace(CM_BF561, spi_clk_hz=1e7), r"board.spi_clk_hz must be of the type Fraction, such as Fraction\(10000000.0\)"),
        (replace(CM_BF561, spi_clk_hz=10), r"of the type Fraction, such as Fraction\(10\), not 10, an int"),
        (replace(CM_BF561, sdram=replace(CM_BF561.sdram, nRP=True)), "board.sdram.nRP must be of the type int, not True"),
        (replace(CM_BF561, sdram=None), "board.sdram must be of the type SdramSpec, not None"),
        (replace(CM_BF561, cameras=list(CM_BF561.cameras)), "board.cameras must be of the type tuple"),
        (replace(CM_BF561, chip=replace(CM_BF561.chip, interrupts=int)), "board.chip.interrupts must be of the type type"),
        (replace(CM_BF561, cameras=(replace(CM_BF561.cameras[0], name=3),) * 2), "board.cameras.0.name must be of the type str"),
        (replace(CM_BF561, clocks=CM_BF561_RATINGS.clocks), "clocks must be those that the pll makes"),
    ):  # fmt: skip
        with pytest.raises(ConfigError, match=problem):
            require_sound(board)


def test_ranges_are_those_of_the_model() -> None:
    """What the compiled code has places for."""
    assert checks.RANGES["sdram.banks"][1] == state.MAX_BANKS
    assert checks.RANGES["chip.external.store_buffer"][1] == state.MAX_STORES
    assert checks.MOST_SUBBANKS == state.MAX_SUBBANKS
    assert checks.MOST_OUTSIDE_L1 == OFFSET_MASK + 1
