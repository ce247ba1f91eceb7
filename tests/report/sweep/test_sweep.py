"""What a sweep's table is made of: columns of one type, the Pareto front, and lines over recordings."""

from __future__ import annotations

import errno
import os
import re
from io import StringIO
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from bfsim.errors import ConfigError
from bfsim.report.sweep.front import front, sign_of
from bfsim.report.sweep.lines import Shown, lines_of
from bfsim.report.sweep.plot import plot_svg
from bfsim.report.sweep.screen import ONE_FRAME, best_table, failures, sweep_report
from bfsim.report.sweep.table import columns_of, csv_of, write_parquet

PLACES = st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), max_size=20)


@given(PLACES)
def test_the_front_is_what_nothing_else_is_better_than(places: list[tuple[int, int]]) -> None:
    """Found by comparing every place with every other."""
    naive = {
        index
        for index, (x, y) in enumerate(places)
        if not any(a <= x and b <= y and (a, b) != (x, y) for a, b in places)
    }
    found = front(places)
    assert set(found) == naive
    assert [places[each] for each in found] == sorted(places[each] for each in found)


def test_more_is_better_of_a_rate_alone() -> None:
    """Of what firmware publishes, and of options, nobody can say."""
    names = ("frame.max ms", "memory.L2 B", "idle.A %", "missed", "frame_rate Hz", "results.x.total", "ldf")
    assert list(map(sign_of, names)) == [1, 1, 1, 1, -1, 0, 0]


def test_a_column_is_numbers_or_text() -> None:
    """In the order in which they first come; what a row does not have is empty."""
    rows = [{"a": 1, "b": 'x,"y"'}, {"a": 2.5, "c": None}, {"b": 3, "c": 4}]
    assert columns_of(rows) == {"a": [1.0, 2.5, None], "b": ['x,"y"', None, "3"], "c": [None, None, 4]}
    assert csv_of(rows) == 'a,b,c\n1.0,"x,""y""",\n2.5,,\n,3,4\n'


@pytest.mark.parametrize("other", [3, 2.5, None])
def test_a_number_without_a_place_in_a_column_is_text(tmp_path: Path, other: float | None) -> None:
    """A value with a digit too many can never work, and is told in a row of its own; the table ended in a traceback."""
    pytest.importorskip("pyarrow")
    rows = [{"set": 10**400}, {"set": other}, {"set": -(2**63) + 1}]
    assert columns_of(rows)["set"] == [str(10**400), other and str(other), str(-(2**63) + 1)]
    write_parquet(tmp_path / "a.parquet", rows)


@pytest.mark.exhaustive
def test_a_plot_takes_any_text() -> None:
    """What XML has no way to write ended the process: the library that draws is not Python."""
    rows = [("a\x1b[31m", {"point": "b\x00", "missed": 0}), ("Straße ⚽", {"point": "c", "missed": 1})]
    svg = plot_svg(rows, ("point", "missed"))
    assert r"a\x1b[31m" in svg
    assert "Straße ⚽" in svg


def test_a_legend_has_room_in_the_widest_font() -> None:
    """Digits are 6.4 px wide in DejaVu, which Linux looks with, at the 10 px of a legend: `cclk_hz=600000000` ended behind 6000."""
    pytest.importorskip("vl_convert")

    def width(name: str) -> int:
        svg = plot_svg([(f"{each}{name}", {"x": each, "y": each}) for each in (1, 2)], ("x", "y"))
        found = re.search(r' width="(\d+)"', svg)
        assert found
        return int(found[1])

    assert width("600000000" * 5) - width("") >= 6.4 * 45


def test_a_table_on_a_full_disk_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As every other file that cannot be written."""

    def write_table(*_arguments: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(pytest.importorskip("pyarrow.parquet"), "write_table", write_table)
    with pytest.raises(ConfigError, match=r"what-if\.parquet must be writable: No space left on device"):
        write_parquet(tmp_path / "what-if.parquet", [{"missed": 0}])


def test_a_line_is_a_setting_over_its_recordings() -> None:
    """The least rate, the lower median of medians, the worst of the rest, and all that was missed."""

    def row(rate: float, frame: float, missed: int) -> dict[str, float]:
        return {
            "frame_rate Hz": rate,
            "frame.median ms": frame,
            "frame.max ms": 2 * frame,
            "latency.median ms": frame + 1,
            "on_chip B": 1024,
            "missed": missed,
        }

    points = [
        Shown("slow", "a", row(10, 5, 1)),
        Shown("slow", "b", row(8, 7, 2)),
        Shown("fast", "a", row(9, 6, 0)),
    ]
    fast, slow = lines_of(points)
    assert (fast.name, fast.recordings, fast.frame_rate_hz) == ("fast", 1, 9)
    found = (
        slow.frame_rate_hz,
        slow.frame_ms,
        slow.worst_ms,
        slow.latency_ms,
        slow.on_chip_bytes,
        slow.missed,
    )
    assert found == (8, 5, 14, 6, 1024, 3)


def test_of_settings_that_the_cameras_bound_the_one_that_works_least_is_first() -> None:
    """Rates differ by when their pictures came: the one that did most stood first."""
    columns = ("frame.max ms", "latency.median ms", "on_chip B", "missed")

    def shown(name: str, rate: float, frame: float) -> Shown:
        return Shown(
            name, "a", {**dict.fromkeys(columns, 1), "frame_rate Hz": rate, "frame.median ms": frame}
        )

    points = [shown("sdram", 60.04, 0.85), shown("L1", 59.98, 0.17), shown("late", 40.0, 0.1), shown("L2", 60.01, 0.3)]  # fmt: skip
    assert [each.name for each in lines_of(points)] == ["L1", "L2", "sdram", "late"]


@pytest.mark.parametrize(("frames", "is_said"), [((2, 1), True), ((2, 2), False)])
def test_the_rate_of_one_frame_is_explained(frames: tuple[int, int], is_said: bool) -> None:
    """Beneath the table that has it, as on the screen of a run."""
    columns = ("frame_rate Hz", "frame.median ms", "frame.max ms", "latency.median ms", "on_chip B", "missed")
    row = {**dict.fromkeys(columns, 1), "error": "", "warnings": ""}
    points = [Shown(f"point {each}", "a", {**row, "frames": each}) for each in frames]
    console = Console(width=110, file=StringIO(), record=True)
    console.print(sweep_report(points, [Path("table.csv")], kept=0, top=5))
    assert (ONE_FRAME in console.export_text()) == is_said


@pytest.mark.parametrize(("top", "said"), [(1, "1 more are in the table; --top N shows N."), (2, "")])
def test_what_has_no_room_in_the_list_is_counted(top: int, said: str) -> None:
    """Where all are listed nothing is said."""
    columns = ("frame_rate Hz", "frame.median ms", "frame.max ms", "latency.median ms", "on_chip B", "missed")
    row = {**dict.fromkeys(columns, 1), "error": "", "warnings": "", "frames": 2}
    lines = lines_of([Shown(f"point {each}", "a", row) for each in range(2)])
    *_, notes = best_table(lines, top)
    assert str(notes).partition("\n")[2] == said


def test_failures_are_told_once_each() -> None:
    """The most frequent first, with some of the names."""
    said = failures([("a", "late"), ("b", "no room"), ("c", "no room"), ("d", "no room"), ("e", "no room")])
    assert said == "4 points failed (b, c, d, …): no room\n1 point failed (a): late"
