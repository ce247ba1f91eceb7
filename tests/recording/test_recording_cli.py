"""`bfsim record import` and `bfsim record info` as a user types them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from PIL import Image

from bfsim.cli.record import record
from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader, StereoGeometry
from bfsim.recording.writer import RecordingWriter


def run(*arguments: object) -> Result:
    """Run `bfsim record` with these arguments."""
    return CliRunner().invoke(record, [str(argument) for argument in arguments])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with three colour images."""
    (tmp_path / "im").mkdir()
    for k in range(3):
        Image.new("RGB", (8, 4), (k, 100, 200)).save(tmp_path / "im" / f"{k}.png")
    return tmp_path


def test_import_then_info(folder: Path) -> None:
    """What was imported is what info tells, in a table and in JSON."""
    out = folder / "run.mcap"
    made = run(
        "import",
        out,
        folder / "im",
        "--mono",
        "--fps",
        12.5,
        "--geometry",
        386,
        30,
        60.5,
        -2,
        "--description",
        "lab",
    )
    assert made.exit_code == 0, made.output
    assert "3 mono frames of 8x4 at 12.5 per second" in made.output
    told = json.loads(run("info", out, "--json").stdout)
    assert (told["width"], told["height"], told["frame_count"], told["description"]) == (8, 4, 3, "lab")
    assert told["geometry"] == {"focal_px": 386.0, "baseline_mm": 30.0, "height_mm": 60.5, "tilt_deg": -2.0}
    assert told["duration_ns"] == 160_000_000
    assert told["left"]["rate_hz"] == pytest.approx(12.5)
    assert told["compression"] == "zstd"
    table = run("info", out).output
    for text in (
        "8x4 UYVY",
        "3 in 0.160 s",
        "12.500 per second",
        "looking down -2",
        "checksums verified",
        "lab",
    ):
        assert text in table


def test_info_shows_how_the_cameras_drift(tmp_path: Path) -> None:
    """Two cameras that are not locked have a rate each, and a skew between them."""
    with RecordingWriter(
        tmp_path / "a.mcap", width=2, height=1, geometry=StereoGeometry(1, 1, 1, 1)
    ) as writer:
        image = np.zeros((1, 4), np.uint8)
        for k in range(3):
            writer.add(image, image, k * 40_000_000, 5_000_000 + k * 41_000_000, {"k": k})
    told = json.loads(run("info", tmp_path / "a.mcap", "--json").stdout)
    assert (told["skew_ns"], told["truth_count"]) == ([5_000_000, 7_000_000], 3)
    assert told["right"]["shortest_interval_ns"] == 41_000_000


def test_resize_and_force(folder: Path) -> None:
    """Options reach the importer."""
    out = folder / "run.mcap"
    out.touch()
    assert isinstance(run("import", out, folder / "im", "--mono").exception, RecordingError)
    assert run("import", out, folder / "im", "--mono", "--resize", "4x2", "--force").exit_code == 0
    with RecordingReader(out) as reader:
        assert (reader.width, reader.height) == (4, 2)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--resize", "16x6"), "Scaled by a triangle filter from 64x24\n"),
        (
            ("--resize", "16x12"),
            "Scaled by a triangle filter from 64x24; 50 % of each is cut off, `--resize 16x6` keeps all\n",
        ),
        (("--resize", "2x2"), "Scaled by a triangle filter from 64x24; 62 % of each is cut off\n"),
        (("--crop", "32x12"), "Cut from 64x24; 75 % of each is cut off, `--resize 32x12` keeps all\n"),
    ],
)
def test_what_is_cut_off_is_told(tmp_path: Path, options: tuple[str, str], said: str) -> None:
    """How much, and the size that keeps the whole picture."""
    Image.new("RGB", (64, 24)).save(tmp_path / "wide.png")
    assert said in run("import", tmp_path / "a.mcap", tmp_path / "wide.png", "--mono", *options).output


def test_many_sizes_and_skipped_files_are_short(tmp_path: Path) -> None:
    """Ten of each, and how many more; a reason is told once."""
    for k in range(12):
        Image.new("L", (8 + 2 * k, 4)).save(tmp_path / f"{k}a.png")
        (tmp_path / f"{k}b.png").write_text("no image")
    lines = run("import", tmp_path / "a.mcap", tmp_path, "--mono", "--resize", "4x2").output.splitlines()
    sizes = ", ".join(f"{8 + 2 * k}x4" for k in range(10))
    names = ", ".join(f"{k}b.png" for k in range(10))
    assert lines[1:] == [
        f"Scaled by a triangle filter from {sizes} and 2 more; up to 73 % of a picture is cut off",
        f"Skipped: {names} and 2 more: file must be an image that Pillow reads, not something else",
    ]


@pytest.mark.parametrize("size", ["320", "320x", "0x240", "320x-1", "axb"])
def test_size_that_is_none(folder: Path, size: str) -> None:
    """A size in another form is a usage error that shows the right one."""
    result = run("import", folder / "run.mcap", folder / "im", "--mono", "--resize", size)
    assert result.exit_code == 2
    assert "must be width x height, such as 320x240" in result.output


def test_damaged_recording(tmp_path: Path) -> None:
    """info passes the reader's error on, for the command line to print."""
    (tmp_path / "a.mcap").write_bytes(b"nothing of the kind")
    result = run("info", tmp_path / "a.mcap")
    assert isinstance(result.exception, RecordingError)
    assert "must be an MCAP file" in str(result.exception)


@pytest.mark.parametrize("command", ["import", "info"])
def test_help_shows_examples(command: str) -> None:
    """The help of a command shows how it is typed."""
    assert f"bfsim record {command} run.mcap" in run(command, "--help").output


def test_a_description_that_is_no_text(folder: Path) -> None:
    """Bytes that are no UTF-8 come from the shell as half characters."""
    result = run("import", folder / "run.mcap", folder / "im", "--mono", "--description", "caf\udce9")
    assert isinstance(result.exception, RecordingError)
    assert str(result.exception).endswith("description must be text in UTF-8, not 'caf\\udce9'")
    assert not (folder / "run.mcap").exists()
