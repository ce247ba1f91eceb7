"""`bfsim run` shows what was seen: pictures, an MCAP file, JSON; from the terminal's side."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from PIL import Image

from bfsim.cli.main import main
from bfsim.cli.options import seen as cli_seen
from tests.report.records import edge_run

BLIND = """
from dataclasses import replace
from tinyphoon import tinyphoon

blind = replace(tinyphoon, view=None)
dazed = replace(tinyphoon, view=lambda readout: readout.values("no such buffer"))
rare = replace(tinyphoon, view=lambda readout: tinyphoon.view(readout) if readout.frame.index else None)
"""


def run(*arguments: object) -> Result:
    """Run the first frame of the built-in recording."""
    command = ["run", "--frames", "1", *map(str, arguments)]
    return CliRunner().invoke(main, command, catch_exceptions=False, prog_name="bfsim")


def refused(*arguments: object) -> str:
    """Run what is a mistake: exit code 2 and one paragraph."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    assert result.stderr.startswith("bfsim: error: ")
    return result.stderr


def test_all_at_once(tmp_path: Path) -> None:
    """The tables as ever, and beside them a folder of pictures, an MCAP file and the JSON with what was seen."""
    folder, mcap, report = tmp_path / "seen", tmp_path / "seen.mcap", tmp_path / "run.json"
    result = run("--overlay", folder, "--mcap", mcap, "--json", report)
    assert result.exit_code == 0, result.output
    assert "frames/s" in result.stdout
    assert sorted(each.name for each in tmp_path.iterdir()) == ["run.json", "seen", "seen.mcap"]
    with Image.open(folder / "frame-0000.png") as image:
        assert image.width > 2 * 960
    with mcap.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary
    assert {"foxglove.SceneUpdate", "foxglove.PointCloud"} < {each.name for each in summary.schemas.values()}
    frame = json.loads(report.read_text())["frames"][0]
    with mcap.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        told = {channel.topic: decoded for _, channel, _, decoded in reader.iter_decoded_messages()}
    for number, core in enumerate("AB"):
        cycles = frame["cores"][number]
        assert told[f"/cost/{core}/frame"].elapsed_ms == (cycles["end_cclk"] - cycles["begin_cclk"]) / 600e3
        edges = next(each for each in cycles["stages"] if each["stage"] == "Edge detection")
        assert told[f"/cost/{core}/edge_detection"].stall_ms == sum(edges["stall_cclk"].values()) / 600e3
        empty = sum(each["stall_cclk"].get("ring empty", 0) for each in cycles["stages"])
        assert told[f"/stalls/{core}"].ring_empty_ms == empty / 600e3 > 0
    assert told["/camera/left/image_rect"].encoding == "rgb8"
    seen = json.loads(report.read_text())["frames"][0]["seen"]
    assert {"times_ns", "objects", "lines_3d", "edges_3d_mm"} == set(seen)


def test_features_in_the_json() -> None:
    """Edges, blobs and lines of both pictures; as many as the firmware says."""
    frame = json.loads(run("--features", "--json", "-").stdout)["frames"][0]
    for camera, core in (("left", "A"), ("right", "B")):
        features = frame["seen"]["cameras"][camera]
        assert len(features["edges"]["x_px"]) == frame["results"][f"edges_{core}"]
        assert len(features["blobs"]) == frame["results"][f"blobs_{core}"]
    assert "--features must come with --json" in refused("--features")


@pytest.mark.exhaustive
def test_show_opens_the_picture_where_there_is_a_display(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without one it says where it is; standard output is the report's."""
    opened: list[str] = []
    monkeypatch.setattr(click, "launch", opened.append)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    result = run("--show", "--json", "-")
    json.loads(result.stdout)
    (path,) = tmp_path.glob("bfsim-*/overlay.gif")
    assert str(path) in result.stderr
    assert not opened
    monkeypatch.setenv("DISPLAY", ":0")
    run("--show", "--overlay", tmp_path / "mine.webp")
    assert opened == [str(tmp_path / "mine.webp")]


def test_windows_has_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    """And says so in no variable."""
    opened: list[str] = []
    monkeypatch.setattr(click, "launch", opened.append)
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("DISPLAY", raising=False)
    cli_seen._show(Path("seen.gif"))
    assert opened == ["seen.gif"]


def test_mistakes_are_told_before_the_run(tmp_path: Path) -> None:
    """A folder with other things in it, a place that is not there, a format that nobody writes."""
    (tmp_path / "thesis.tex").write_text("")
    assert "holds thesis.tex" in refused("--overlay", tmp_path)
    assert "*.gif" in refused("--overlay", tmp_path / "seen.bmp")
    assert "must exist" in refused("--mcap", tmp_path / "missing" / "seen.mcap")
    assert [each.name for each in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.exhaustive
def test_firmware_without_a_view_shows_pictures_and_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What the camera saw, and what was published; a plain JSON has no `seen` then, and features are refused."""
    (tmp_path / "short_sighted.py").write_text(BLIND)
    monkeypatch.syspath_prepend(tmp_path)
    blind = "--firmware", "short_sighted:blind"
    done = run(*blind, "--overlay", tmp_path / "seen", "--mcap", tmp_path / "seen.mcap", "--json", "-")
    assert "seen" not in json.loads(done.stdout)["frames"][0]
    assert (tmp_path / "seen.mcap").exists()
    with Image.open(tmp_path / "seen" / "frame-0000.png") as sheet:
        assert sheet.width > 320
    message = refused(*blind, "--features", "--json", tmp_path / "run.json")
    assert "--features must go with firmware that has a view to tell what it sees" in message


@pytest.mark.exhaustive
def test_a_frame_in_which_nothing_was_seen_has_no_costs_either(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody knows when it was."""
    (tmp_path / "rare_views.py").write_text(BLIND)
    monkeypatch.syspath_prepend(tmp_path)
    command = ["run", "--frames", "2", "--firmware", "rare_views:rare", "--mcap", str(tmp_path / "seen.mcap")]
    assert CliRunner().invoke(main, command, catch_exceptions=False).exit_code == 0
    with (tmp_path / "seen.mcap").open("rb") as stream:
        told = {
            (channel.topic, message.sequence) for _, channel, message in make_reader(stream).iter_messages()
        }
    assert {frame for _, frame in told} == {1}
    assert ("/cost/frame", 1) in told


def test_layers_are_some_of_what_is_drawn(tmp_path: Path) -> None:
    """By their names; they need something to be drawn on."""
    unknown = run("--overlay", tmp_path / "seen", "--layers", "edges,clouds")
    assert unknown.exit_code == 2
    assert "must be some of edges, blobs" in unknown.stderr
    assert "--layers must come with --overlay" in refused("--layers", "edges")
    both = tmp_path / "seen.gif"
    assert "seen.gif must be a file of its own" in refused("--overlay", both, "--mcap", both)
    assert not both.exists()


@pytest.mark.exhaustive
def test_a_view_that_fails_is_told_with_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And nothing is left of what was to be written."""
    (tmp_path / "dazed_firmware.py").write_text(BLIND)
    monkeypatch.syspath_prepend(tmp_path)
    message = refused("--firmware", "dazed_firmware:dazed", "--overlay", tmp_path / "seen")
    assert "no such buffer" in message
    assert "dazed_firmware.py:6" in message
    assert not (tmp_path / "seen").exists()


def test_ctrl_c_before_the_first_frame_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There is nothing to draw, and nothing is left."""
    interrupted = replace(edge_run(100), frames=(), interrupted=True)
    monkeypatch.setattr("bfsim.run.simulate", lambda **_: interrupted)
    result = run("--overlay", tmp_path / "seen.gif", "--mcap", tmp_path / "seen.mcap")
    assert (result.exit_code, result.stderr) == (130, "bfsim: interrupted before the first frame was done\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.exhaustive
def test_heat_is_drawn_and_told_and_changes_nothing(tmp_path: Path) -> None:
    """A picture with it is larger by its bars and legend; the MCAP file has it; the numbers are those without."""
    plain, heat, mcap = tmp_path / "plain", tmp_path / "heat", tmp_path / "seen.mcap"
    before = run("--overlay", plain, "--layers", "objects")
    after = run("--overlay", heat, "--mcap", mcap, "--heat")
    assert after.exit_code == 0, after.output
    assert after.stdout == before.stdout
    with Image.open(plain / "frame-0000.png") as one, Image.open(heat / "frame-0000.png") as other:
        assert one.width < other.width
        assert one.height < other.height
    with mcap.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        told = {channel.topic: decoded for _, channel, _, decoded in reader.iter_decoded_messages()}
    for camera in ("left", "right"):
        picture, heated = told[f"/camera/{camera}/image_rect"], told[f"/camera/{camera}/heat"]
        assert (picture.width, picture.height, picture.encoding) == (
            heated.width,
            heated.height,
            heated.encoding,
        )
        assert picture.data != heated.data


def test_heat_of_a_stage_that_is_not_there(tmp_path: Path) -> None:
    """It says which there are, and what may have been meant; and heat that nobody sees is a mistake."""
    told = refused("--overlay", tmp_path / "heat", "--heat", "drive.mcap")
    assert "Edge detection, Rectification" in told
    assert "a RECORDING goes before it" in told
    assert "--heat must come with --overlay" in refused("--heat")
