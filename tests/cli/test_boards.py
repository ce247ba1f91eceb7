"""`bfsim boards`: every board has its line, and every field of a board its number."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import pytest
from click.testing import CliRunner, Result

from bfsim.chip.boards import BOARDS
from bfsim.cli.main import main


def call(*arguments: str) -> Result:
    """Call the command line in this process."""
    return CliRunner().invoke(main, ("boards", *arguments), catch_exceptions=False, env={"COLUMNS": "100"})


def field_names(record: object) -> Iterator[str]:
    """Every field of a tree of dataclasses."""
    for field in fields(record):  # type: ignore[arg-type]
        value = getattr(record, field.name)
        inner = value if isinstance(value, tuple) else (value,)
        if is_dataclass(inner[0]):
            for each in inner:
                yield from field_names(each)
        else:
            yield field.name


def test_list_has_a_line_for_each_board() -> None:
    """Clocks, size and timing stand beside the name."""
    lines = call().output.splitlines()
    rows = {line.split()[0]: line.split() for line in lines if line.split() and line.split()[0] in BOARDS}
    assert list(rows) == list(BOARDS)
    assert rows["cm-bf561-ratings"][1:6] == ["ADSP-BF561", "600/133.333", "32", "MB", "3-2-2-7-2"]
    assert rows["bf561-ezkit"][1:6] == ["ADSP-BF561", "600/120", "64", "MB", "3-3-3-6-2"]
    assert rows["cm-bf533"][1:6] == ["ADSP-BF533", "550/110", "32", "MB", "3-2-2-7-2"]


@pytest.mark.parametrize("name", BOARDS)
def test_one_board_shows_every_field(name: str) -> None:
    """Nothing that the simulator uses is kept back."""
    output = call(name).output
    words = set(re.split(r"[\s.]+", output))
    assert [field for field in field_names(BOARDS[name]) if field not in words] == []
    assert set(BOARDS[name].chip.interrupts.__members__) <= words
    assert "…" not in output


def test_values_are_readable() -> None:
    """Addresses in hexadecimal, sizes with their thousands apart, and what is not there has no number."""
    words = [line.split() for line in call("cm-bf533").output.splitlines()]
    assert ["0", "L1_CODE", "A", "0xFFA00000", "65,536", "0"] in words
    assert ["chip.l2", "none"] in words
    assert ["clocks.sclk_hz", "110,000,000"] in words
    assert ["chip.max_sclk_hz", "133,333,333.333"] in words
    assert ["dma_over_core", "no"] in words
    assert ["PPI0_DMA", "8", "8"] in words


def test_unknown_board_is_told_the_known_ones() -> None:
    """The same message as for the option, and the exit code of a mistake."""
    result = call("cm-bf562")
    assert result.exit_code == 2
    assert result.stderr.startswith("bfsim: error: --board must be one of cm-bf561, ")


def test_board_option_says_where_the_names_are() -> None:
    """Whoever looks for a board's name finds the command that lists them."""
    help_text = CliRunner().invoke(main, ["run", "--help"]).output
    assert "`bfsim boards` lists them" in " ".join(help_text.split())
