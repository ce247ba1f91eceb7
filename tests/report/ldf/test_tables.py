"""The memory map in the terminal: bars to scale, tables that fit, findings with their advice."""

from __future__ import annotations

import json
from dataclasses import replace

from rich.console import Console, RenderableType

from bfsim.report.ldf.bars import CELLS, bars, cells_of
from bfsim.report.ldf.lint import lint
from bfsim.report.ldf.map import ContentKind
from bfsim.report.ldf.tables import SCHEMA, ldf_json, ldf_report
from tests.report.ldf_maps import BANK_BYTES, a_map, a_segment, a_symbol

CAMERA = a_symbol("camera", ContentKind.CAMERA, "A", 0, BANK_BYTES // 4)
IMAGE = a_symbol("image", ContentKind.LINES, "B", BANK_BYTES // 2, BANK_BYTES // 2)
DOT = a_symbol("dot", ContentKind.ROW, "A", BANK_BYTES // 4, 16)
SDRAM = a_segment("SDRAM", CAMERA, DOT, IMAGE, used_bytes=3 * BANK_BYTES // 4, takes=("bank0", "bank1"))
MAP = a_map(SDRAM)


def text_of(report: RenderableType) -> list[str]:
    """Lines of a report as they are printed at 80 columns."""
    console = Console(width=80, markup=False, emoji=False, highlight=False)
    with console.capture() as capture:
        console.print(report)
    return [line.rstrip() for line in capture.get().splitlines()]


def test_bars_are_to_scale() -> None:
    """A quarter of the segment is a quarter of the cells."""
    names = [each.name for each in cells_of(SDRAM, CELLS)]
    assert names.count("camera") == CELLS // 4
    assert names.count("image") == CELLS // 2


def test_small_buffers_show_before_what_has_no_name() -> None:
    """A buffer alone in its cell is seen however small it is, and the legend has all."""
    lines = text_of(bars(MAP))
    assert lines[2].strip().startswith("a" * (CELLS // 4) + "b")
    assert "a camera (A) 2.00 MB  b dot (A) 16 B  c image (B) 4.00 MB" in lines[3]


def test_the_report_has_every_part() -> None:
    """Fullness, picture, output sections, symbols, findings: in that order."""
    lines = text_of(ldf_report(MAP, lint(MAP), symbols=True))
    text = "\n".join(lines)
    assert lines[0] == "test.ldf on test-board: test:firmware, 320x240 px"
    row = next(line for line in lines if line.startswith("MEM_SDRAM "))
    assert row.split() == ["MEM_SDRAM", "SDRAM", "0x00000000", "6.00", "MB", "75.0", "2.00", "MB"]
    parts = ["Segments", "Picture", "Output sections", "Symbols", "To look at"]
    assert sorted(parts, key=text.index) == parts
    assert "bank0 bank1" in text
    assert any(line.split()[:4] == ["image", "0x00400000", "4,194,304", "B"] for line in lines)
    assert "- SDRAM bank 0: streams share a bank" in lines
    assert max(map(len, lines)) <= 80


def test_symbols_can_be_left_out() -> None:
    """Then the table of symbols is not there; the rest is."""
    lines = text_of(ldf_report(MAP, (), symbols=False))
    assert not any(line.startswith("Symbols") for line in lines)
    assert "To look at: nothing." in lines


def test_without_firmware_nothing_is_judged() -> None:
    """Segments and what they take, and the reason why there is no more."""
    empty = replace(
        MAP, firmware="", why_without="of another chip", segments=(replace(SDRAM, symbols=(), pieces=()),)
    )
    text = "\n".join(text_of(ldf_report(empty, (), symbols=True)))
    assert "no firmware: of another chip" in text
    assert "bank0 bank1" in text
    assert "Picture" not in text
    assert "Symbols\n" not in text


def test_json_holds_map_and_findings() -> None:
    """Keys are the records' field names."""
    plain = json.loads(ldf_json(MAP, lint(MAP)))
    assert plain["schema"] == SCHEMA
    assert plain["segments"][0]["symbols"][0]["name"] == "camera"
    assert plain["segments"][0]["symbols"][0]["kind"] == "camera"
    assert {each["rule"] for each in plain["findings"]} >= {"streams share a bank"}
