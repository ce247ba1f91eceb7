"""The command `bfsim boards`: every number in the dataclasses of a board, under its own name."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from bfsim.chip.interrupts import SicInterrupt
from bfsim.cli.options.hardware import SET_OPTION
from bfsim.errors import ConfigError
from bfsim.fields import leaves
from bfsim.process.terminal import print_report

if TYPE_CHECKING:
    from bfsim.chip.spec import BoardSpec
    from bfsim.report.boards import Rows


@click.command(short_help="List the boards, or print every number of one.")
@click.argument("name", required=False)
@SET_OPTION
def boards(name: str | None, settings: dict[str, str]) -> None:
    """List the boards that --board takes; with NAME, print every number of that board.

    Each number stands beside its path, which --set takes. Units are in the names: _cclk and _sclk are cycles of the core
    and of the bus; nCL, nRAS, nRP, nRCD and nWR are SCLK cycles, too. With --set, the changes come first, with what follows
    from them: the clocks from the PLL, or the PLL from the clocks, and the memory map from the SDRAM.

    NAME may also be your own board, FILE.py:NAME or PACKAGE:NAME.

    \b
    Examples:
      bfsim boards
      bfsim boards cm-bf561
      bfsim boards cm-bf561 --set sdram.nRP=3 --set pll.ssel=6
    """
    from bfsim.chip.boards import BOARDS
    from bfsim.loading.hardware import find_board
    from bfsim.report.boards import board_report, boards_report

    if name is None:
        if settings:
            raise ConfigError("--set must come with the NAME of a board")
        print_report(boards_report([_summary(each) for each in BOARDS.values()]))
        return
    board = find_board(name, settings).value
    blocks = _blocks("", board)
    if settings:
        blocks.insert(0, ("changed", _changes(find_board(name).value, board)))
    print_report(board_report(f"{board.name}: {board.title}", blocks))


def _changes(before: BoardSpec, after: BoardSpec) -> Rows:
    """Return the differences, by path; a missing record counts as none."""
    was, now = ({each.path: each for each in leaves(board)} for board in (before, after))
    rows = []
    for path in dict.fromkeys((*was, *now)):
        old, new = (
            _text(path.rpartition(".")[2], at[path].value) if path in at else "none" for at in (was, now)
        )
        if old != new and path != "name":
            rows.append({"path": path, "was": old, "is": new})
    return rows or [{"": "nothing: the board has these numbers"}]


def _summary(board: BoardSpec) -> dict[str, str]:
    sdram = board.sdram
    return {
        "Board": board.name,
        "Chip": board.chip.name,
        "CCLK/SCLK\nMHz": f"{_mhz(board.clocks.cclk_hz)}/{_mhz(board.clocks.sclk_hz)}",
        "SDRAM": f"{sdram.nbytes >> 20} MB",
        "CL-RCD-RP\n-RAS-WR": f"{sdram.nCL}-{sdram.nRCD}-{sdram.nRP}-{sdram.nRAS}-{sdram.nWR}",
        "Title": board.title,
    }


def _mhz(hz: Fraction) -> str:
    return f"{float(hz / 1_000_000):g}"


def _blocks(path: str, record: Any) -> list[tuple[str, Rows]]:
    """Return the numbers of a record, followed by those of each record in it, by path."""
    own = []
    inner: list[tuple[str, Rows]] = []
    for field in fields(record):
        value = getattr(record, field.name)
        where = f"{path}.{field.name}" if path else field.name
        if is_dataclass(value):
            inner += _blocks(where, value)
        elif isinstance(value, tuple) and is_dataclass(value[0]):
            rows = [{"N": f"{number}"} | _cells(each) for number, each in enumerate(value)]
            inner.append((f"{where}.N", rows))
        elif isinstance(value, type) and issubclass(value, SicInterrupt):
            inner.append((where, [_interrupt(each) for each in value]))
        else:
            own.append({"": where, "value": _text(field.name, value)})
    return [(path or "board", own), *inner]


def _cells(record: Any) -> dict[str, str]:
    return {field.name: _text(field.name, getattr(record, field.name)) for field in fields(record)}


def _interrupt(interrupt: SicInterrupt) -> dict[str, str]:
    return {"source": interrupt.name, "number": f"{interrupt:d}", "ivg": f"{interrupt.ivg}"}


def _text(name: str, value: object) -> str:
    """Return a value for people: addresses in hexadecimal, other numbers with thousands separated."""
    if name == "start":
        return f"0x{value:08X}"
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int | Fraction):
        return f"{float(value):,.12g}"
    return ", ".join(value) if isinstance(value, tuple) else str(value)
