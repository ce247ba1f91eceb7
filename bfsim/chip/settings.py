"""A board with other numbers, as set by `--set PATH=VALUE`, and what follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from bfsim.chip.checks import require_sound
from bfsim.chip.memory_map import Region
from bfsim.chip.spec import BoardSpec, Pll
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError, cut
from bfsim.fields import leaf_at, parsed, with_values

ALSO = {"cl": "nCL", "trcd": "nRCD", "trp": "nRP", "tras": "nRAS", "twr": "nWR"}
"""Fields of SdramSpec by their names in EBIU_SDGCTL, in lower case; both are SCLK cycles."""


def with_settings(board: BoardSpec, settings: Mapping[str, object]) -> tuple[BoardSpec, tuple[str, ...]]:
    """Return a board with other numbers by their paths, and the settings as PATH=VALUE, sorted and in one spelling.

    Values are numbers, or text as for `--set`. What follows from them is set, too: the clocks from the PLL, or the PLL
    from the clocks, if a setting of it makes them; the memory map from the SDRAM's size. Raises ConfigError, with the
    setting, for a path that does not exist and a value that no board can have.
    """
    values: dict[str, int | Fraction | bool] = {}
    for path, value in settings.items():
        try:
            leaf = leaf_at(board, path, ALSO)
            _require_new(leaf.path, values)
            values[leaf.path] = parsed(str(value), leaf.hint)
        except ConfigError as error:
            raise ConfigError(f"--set {cut(f'{path}={value}')}: {error}") from error
    names = tuple(sorted(f"{path}={_written(value)}" for path, value in values.items()))
    try:
        changed = _followed(with_values(board, values), {path.partition(".")[0] for path in values})
        if values:
            require_sound(changed)
    except ConfigError as error:
        raise ConfigError(f"{' '.join(f'--set {cut(each)}' for each in names)}: {error}") from error
    return changed, names


def _require_new(path: str, values: Mapping[str, object]) -> None:
    if path in values:
        raise ConfigError(f"{path} must be set once, not twice")


def _written(value: float | Fraction) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value)


def _followed(board: BoardSpec, parts: set[str]) -> BoardSpec:
    """Return a board whose `parts` were set, with what follows from them."""
    if {"pll", "clocks"} <= parts:
        raise ConfigError("pll and clocks must not both be set: either follows from the other")
    if "pll" in parts and board.pll:
        board = replace(board, clocks=board.chip.clocks_of(board.pll))
    elif "clocks" in parts and board.pll:
        board = replace(board, pll=_pll_of(board, board.clocks))
    if "sdram" in parts:
        regions = tuple(_resized(each, board.sdram.nbytes) for each in board.chip.regions)
        board = replace(board, chip=replace(board.chip, regions=regions))
    return board


def _pll_of(board: BoardSpec, clocks: Clocks) -> Pll | None:
    """Return the setting that makes these clocks of the board's crystal, with the slowest VCO, or None."""
    assert board.pll
    for csel in (1, 2, 4, 8):
        multiplier = clocks.cclk_hz * csel / board.pll.clkin_hz
        ssel = clocks.cclk_hz * csel / clocks.sclk_hz
        if multiplier.denominator == ssel.denominator == 1 and multiplier <= 64 and ssel <= 15:
            return Pll(clkin_hz=board.pll.clkin_hz, vco_multiplier=int(multiplier), csel=csel, ssel=int(ssel))
    return None


def _resized(region: Region, sdram_nbytes: int) -> Region:
    is_same = region.memory != "SDRAM" or region.nbytes == sdram_nbytes
    return region if is_same else replace(region, nbytes=sdram_nbytes)
