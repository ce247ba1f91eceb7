"""The file of a sweep: which points it stands for, and what it must not say."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from bfsim.errors import ConfigError
from bfsim.sweeping.file import Point, read_sweep


def points_of(text: str, folder: Path) -> list[Point]:
    """Read a sweep from a text."""
    (folder / "what-if.toml").write_text(text)
    return read_sweep(folder / "what-if.toml", folder / "scripts")


def orders_of(point: Point) -> object:
    """What the script of a point says."""
    return json.loads(Path(point.configuration.script).read_text())


def test_every_combination_and_then_each_point(tmp_path: Path) -> None:
    """The last axis turns fastest; a point has the base, and nothing of the axes."""
    text = """
        base = {frames = 5, set.sdram.nCL = 3}
        axes = {ldf = ["l2", "thesis"], set = {"sdram.nRP" = [2, 3.0]}}
        point = [{name = "slow", set.sdram.nCL = 2}, {profile = "gcc-O0"}]
    """.replace("\n        ", "\n")
    points = points_of(text, tmp_path)
    assert [each.name for each in points] == [
        "ldf=l2 nRP=2", "ldf=l2 nRP=3", "ldf=thesis nRP=2", "ldf=thesis nRP=3", "slow", "profile=gcc-O0",
    ]  # fmt: skip
    found = [each.configuration.model_dump(exclude_defaults=True) for each in points]
    assert found[1] == {"frames": 5, "ldf": "l2", "set": {"sdram.nCL": "3", "sdram.nRP": "3"}}
    assert found[4] == {"frames": 5, "set": {"sdram.nCL": "2"}}
    assert found[5] == {"frames": 5, "set": {"sdram.nCL": "3"}, "profile": "gcc-O0"}


def test_configurations_are_an_axis(tmp_path: Path) -> None:
    """Several options that change together, times the other axes; what has a name is called by it."""
    text = """
        [axes]
        recording = ["a.mcap", "b.mcap"]
        [[axes.configuration]]
        name = "as it is"
        [[axes.configuration]]
        ldf = "l2"
        set.clocks.cclk_hz = 500e6
    """
    points = points_of(text, tmp_path)
    assert [(each.recording, each.setting) for each in points] == [
        ("a.mcap", "as it is"), ("a.mcap", "ldf=l2 clocks.cclk_hz=500000000"),
        ("b.mcap", "as it is"), ("b.mcap", "ldf=l2 clocks.cclk_hz=500000000"),
    ]  # fmt: skip
    assert points[3].configuration.set == {"clocks.cclk_hz": "500000000"}


def test_recordings_by_pattern(tmp_path: Path) -> None:
    """In the order of their names, each once; a name that is a file is no pattern."""
    for name in ("b.mcap", "a.mcap", "[c].mcap"):
        (tmp_path / name).touch()
    points = points_of('axes.recording = ["?.mcap", "[c].mcap", "a.mcap"]', tmp_path)
    assert [each.name for each in points] == ["a.mcap", "b.mcap", "[c].mcap"]


def test_a_recording_is_one_by_any_way_to_it(tmp_path: Path) -> None:
    """It is called as it was first."""
    for name in ("a.mcap", "b.mcap"):
        (tmp_path / name).touch()
    (tmp_path / "linked.mcap").symlink_to("a.mcap")
    (tmp_path / "circle").symlink_to("circle")
    ways = ["a.mcap", f"{tmp_path}/a.mcap", "./b.mcap", "linked.mcap", f"{tmp_path}/?.mcap"]
    points = points_of(f"axes.recording = {ways}", tmp_path)
    assert [each.name for each in points] == ["a.mcap", "./b.mcap"]
    assert len(points_of('axes.recording = ["circle", "no\\u0000name", "a.mcap"]', tmp_path)) == 3


def test_scripts_by_their_paths(tmp_path: Path) -> None:
    """Areas times thresholds, in tables and lists that a path makes; points that say the same have the same file."""
    text = """
        [axes.script]
        "send.0.mode.area" = [[0, 0, 32, 16], [8, 4, 16, 8]]
        send.0.mode.edges.edge_threshold = [12, 20]
        [[point]]
        script = {send = [{mode = {area = [8, 4, 16, 8], edges = {edge_threshold = 20}}}]}
    """
    points = points_of(text, tmp_path)
    assert points[3].name == "area=[8, 4, 16, 8] edge_threshold=20"
    mode = {"area": [8, 4, 16, 8], "edges": {"edge_threshold": 20}}
    assert orders_of(points[3]) == {"send": [{"mode": mode}]}
    assert points[3].configuration.script == points[4].configuration.script
    assert len({each.configuration.script for each in points}) == 4


def test_a_path_into_a_script_that_is_a_file(tmp_path: Path) -> None:
    """The rest of the file stays, and the file itself too."""
    (tmp_path / "orders.toml").write_text("[[send]]\nmode.area = [0, 0, 8, 8]\nafter_frames = 3\n")
    text = 'base.script = "orders.toml"\n[axes.script]\n"send.0.mode.area" = [[2, 2, 8, 8]]\n"send.1" = [{mode = {}}]'
    (point,) = points_of(text, tmp_path)
    assert orders_of(point) == {"send": [{"mode": {"area": [2, 2, 8, 8]}, "after_frames": 3}, {"mode": {}}]}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("= 3", "must be TOML: "),
        ("a = " + "[" * 100_000, "must be TOML: "),
        ("\udcff", "must be TOML: "),
        ("", "there must be a list in [axes], or a [[point]]"),
        ("axis = {}", "axis must not be there; known are [base], [axes] and [[point]]"),
        ("[[run]]\nname = 'a'", "it must be a sweep, with [axes] or [[point]], not a baseline of `bfsim check`"),
        ("run.frames = 2\naxes.ldf = ['l2']", "run must not be there; known are [base], [axes] and [[point]]"),
        ("base = 3", "base must be a table of options, not 3"),
        ("axes = []", "axes must be a table of lists, not []"),
        ("point = {}", "point must be a list of tables, [[point]], not {}"),
        ("point = [3]", "point.1 must be a table of options, not 3"),
        ("point = [{name = 3}]", "point.1.name must be text, not 3"),
        ("axes.'set.sdram.nRP' = [1]", "axes.set.sdram.nRP must not be there; it is written without quotes: set.sdram.nRP"),
        ("axes.clock = [1]", "axes.clock must not be there; known keys are recording, firmware, board, set"),
        ("axes.sdram.nRP = [3]", "axes.sdram must not be there; a number of the board is written set.sdram.nRP"),
        ("axes.ldf = 'l2'", "axes.ldf must be a list of values, not 'l2'"),
        ("axes.ldf = []", "axes.ldf must be a list of values, not []"),
        ("axes.set = [1]", "axes.set must be a table of names and values, not [1]"),
        ("axes.set.sdram.nRP = [[1]]", "set.sdram.nRP must be a number, text, or true or false, not [1]"),
        ("axes.set.sdram.nRP = [1979-05-27]", "set.sdram.nRP must be a number, text, or true or false, not"),
        ("axes.frames = [0]", "frames must be greater than or equal to 1, not 0"),
        ("axes.frames = [true]", "point 'base': frames must be a valid integer, not True"),
        ("axes.frames = [1]\npoint = [{name = 'late', feed = 'fast'}]", "point 'late': feed must be 'demand', 'recorded' or 'cameras'"),
        ("axes.feed = ['fast']", "feed must be 'demand', 'recorded' or 'cameras', not 'fast'"),
        ("axes.recording = ['*.mcap']", "axes.recording must match a file, and '*.mcap' matches none"),
        ("axes.recording = [3]", "recording must be a valid string, not 3"),
        ("axes.configuration = 3", "axes.configuration must be a list of tables"),
        ("axes.ldf = ['l2']\naxes.configuration = [{ldf = 'l2'}]", "ldf must be in one axis, not in both"),
        ("base.ldf = ['l2', 'sdram']\naxes.frames = [1]", "ldf must be a valid string, not ['l2', 'sdram']; several values are a list in [axes]"),
        ("axes.script = [3]", "script must be a valid string, not 3"),
        ("base.script = 'no.toml'\naxes.script.send = [[]]", "no.toml must be a readable file"),
        ("axes.script.day = [1979-05-27]", "script must be numbers, text, lists and tables"),
        ("axes.script.x = [nan]", "script must be numbers, text, lists and tables"),
        ("base.script.x = 3\naxes.script = {'x.y' = [1]}", "script.x.y must lead through tables and lists, and 'y' is below 3"),
        ("axes.script = {'send.1.x' = [1]}", "script.send.1.x: '1' must be the number of one of the list's 0 entries"),
        ("base.script.send = []\naxes.script = {'send.²' = [1]}", "'²' must be the number of one of"),
        ("axes.ldf = ['l2', 'l2']", "each point must be listed once, not twice: 'ldf=l2'"),
        ("axes.ldf = ['l2', 'thesis']\npoint = [{ldf = 'l2'}]", "each point must be listed once, not twice: 'ldf=l2'"),
        ("point = [{name = ' '}]", "point.1.name must be text, not ' '"),
        ("point = [{name = 'x'}, {name = 'x', ldf = 'l2'}]", "different points must have different names, but two are called 'x'"),
        (f"axes = {{frames = {[1] * 1000}, ldf = {['a'] * 1000}}}", "at most 100,000 points, not 1,000,000"),
    ],
)  # fmt: skip
def test_what_a_file_must_not_say(text: str, message: str, tmp_path: Path) -> None:
    """One sentence with the file, the key, what must be and what was."""
    (tmp_path / "what-if.toml").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ConfigError) as caught:
        read_sweep(tmp_path / "what-if.toml", tmp_path / "scripts")
    assert str(caught.value).startswith(str(tmp_path / "what-if.toml"))
    assert message in str(caught.value)
    assert len(str(caught.value)) < 600


def test_names_are_on_one_line_and_can_be_seen(tmp_path: Path) -> None:
    """Of points and of values: what drives a terminal, or breaks a table, is written as Python does; words of all languages stay."""
    text = r"""
        axes.define.DAY = ["a\u001b[31m", "日"]
        point = [{name = "Straße ⚽"}, {name = "two\nlines", ldf = "l2"}]
    """.replace("\n        ", "\n")
    names = [each.name for each in points_of(text, tmp_path)]
    assert names == ["DAY=a\\x1b[31m", "DAY=日", "Straße ⚽", "two\\nlines"]


def test_a_file_of_windows_is_read(tmp_path: Path) -> None:
    """With its mark at the beginning."""
    (tmp_path / "what-if.toml").write_text("axes.ldf = ['l2', 'thesis']", encoding="utf-8-sig")
    assert len(read_sweep(tmp_path / "what-if.toml", tmp_path / "scripts")) == 2


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    """Or is a folder."""
    for path in (tmp_path / "no.toml", tmp_path):
        with pytest.raises(ConfigError, match="must be a readable file"):
            read_sweep(path, tmp_path)
