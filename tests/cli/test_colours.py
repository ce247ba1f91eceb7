"""`bfsim colours`: what the firmware calls the colours of a picture, for people."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from PIL import Image

from bfsim.cli.main import main
from bfsim.recording.importing.image_files import picture_of_file
from bfsim.recording.writer import RecordingWriter
from bfsim.shipped import RECORDING

OTHER = """
import numpy as np
from bfsim.api import BudgetRow, Firmware, NamedColour, PictureColours

def halves(picture, script, frame):
    if frame == 3:
        raise ValueError("no such colour")
    numbers = np.zeros((picture.shape[0], picture.shape[1] // 2), np.uint8)
    numbers[:, : numbers.shape[1] // 2] = script.get("number", 1)
    named = (NamedColour(name="right", colour=(1, 2, 3)), NamedColour(name="left", colour=(9, 8, 7), hue_deg=(0, 180)))
    return PictureColours(numbers=numbers[: frame + 6], named=named)

both = {"mains": {}, "buffers": lambda size: {}, "camera": "camera", "rows": (BudgetRow(stage="all"),)}
halving = Firmware(**both, colours=halves)
plain = Firmware(**both)
"""


def call(*arguments: object) -> Result:
    """Call the command line in this process."""
    return CliRunner().invoke(main, ("colours", *map(str, arguments)))


def refused(*arguments: object) -> str:
    """What a call that is refused says, on one line."""
    result = call(*arguments)
    assert result.exit_code == 2
    return " ".join(result.output.split())


def seen(*arguments: object) -> dict[str, float]:
    """The colours that a picture has some of, and their shares to a hundredth."""
    found = json.loads(call(*arguments, "--json").output)["colours"]
    return {each["name"]: round(each["share"], 2) for each in found if each["share"]}


@pytest.fixture
def thirds(tmp_path: Path) -> Path:
    """A picture of three thirds: an orange, a grey and a navy one."""
    picture = Image.new("RGB", (9, 6), (255, 128, 0))
    picture.paste((110, 110, 100), (0, 2, 9, 4))
    picture.paste((0, 0, 128), (0, 4, 9, 6))
    picture.save(tmp_path / "thirds.png")
    return tmp_path / "thirds.png"


@pytest.fixture
def other(tmp_path: Path) -> Path:
    """A file of firmware of another robot."""
    path = tmp_path / "other.py"
    path.write_text(OTHER)
    return path


def test_the_table_has_each_colour_with_its_hue_and_its_share(thirds: Path) -> None:
    """By name and in degrees; grey has no colour, and dark blue is blue."""
    lines = [line.split() for line in call(thirds).output.splitlines()]
    assert ["■", "orange", "309", "to", "321", "33.3"] in lines
    assert ["■", "blue", "90", "to", "103", "33.3"] in lines
    assert ["■", "no", "colour", "33.3"] in lines
    assert sum(line[:1] == ["■"] for line in lines) == 31


def test_the_picture_stands_beside_its_colours(thirds: Path, tmp_path: Path) -> None:
    """As it is, then an orange, grey and blue third, the last column of the odd width left out; below, the legend."""
    out = tmp_path / "out.png"
    assert call(thirds, "--out", out).exit_code == 0
    with Image.open(out) as sheet:
        scale = 60  # of 8 columns to half of 960
        assert sheet.width == 2 * 8 * scale + 20
        assert sheet.height > 6 * scale + 20
        orange = sheet.getpixel((scale, scale))
        assert isinstance(orange, tuple)
        assert max(abs(a - b) for a, b in zip(orange, (255, 128, 0), strict=True)) <= 2
        red, green, blue = sheet.getpixel((9 * scale + 20, scale))  # type: ignore[misc]
        assert red > green > blue
        assert sheet.getpixel((9 * scale + 20, 3 * scale)) == (128, 128, 128)


def test_a_mode_changes_what_colours_are_called(thirds: Path, tmp_path: Path) -> None:
    """With the thesis's rule the grey third is yellow, from the frame on in which the order holds."""
    script = tmp_path / "thesis.json"
    edges = {"least_chroma": 0}
    script.write_text(json.dumps({"send": [{"mode": {"edges": edges}}]}))
    assert seen(thirds) == {"orange": 0.33, "blue": 0.33, "no colour": 0.33}
    assert seen(thirds, "--script", script) == {"orange": 0.33, "yellow": 0.33, "black": 0.33}
    script.write_text(json.dumps({"send": [{"after_frames": 2, "mode": {"edges": edges}}]}))
    frames = [seen(RECORDING, "--script", script, "--frame", frame) for frame in (2, 3)]
    assert frames[0]["no colour"] > 0
    assert "no colour" not in frames[1]


def test_an_order_that_the_chip_would_refuse_is_told(thirds: Path, tmp_path: Path) -> None:
    """By the file, the word, and what it may be."""
    script = tmp_path / "bad.json"
    script.write_text('{"send": [{"mode": {"edges": {"red_gain": 300}}}]}')
    told = "bad.json: edges.red_gain must be 16 to 255, not 300"
    assert told in refused(thirds, "--script", script)


def test_the_gains_of_a_grey_patch_make_it_grey(tmp_path: Path) -> None:
    """Of a grey wall in yellow light the measured gains leave no colour; the ball beside it keeps its own."""
    picture = Image.new("RGB", (64, 32), (170, 140, 90))
    picture.paste((40, 50, 110), (32, 0, 64, 32))
    picture.save(tmp_path / "wall.png")
    assert seen(tmp_path / "wall.png") == {"orange": 0.5, "blue": 0.5}
    found = json.loads(call(tmp_path / "wall.png", "--grey", "4,4,20x20", "--json").output)
    words = found["patch_notes"][0].split()
    gains = {each: int(words[words.index(f"edges.{each}") + 1]) for each in ("red_gain", "blue_gain")}
    script = tmp_path / "wall.json"
    script.write_text(json.dumps({"send": [{"mode": {"edges": gains}}]}))
    assert seen(tmp_path / "wall.png", "--script", script) == {"white": 0.5, "blue": 0.5}


def test_a_frame_of_a_recording_is_a_picture(tmp_path: Path, thirds: Path) -> None:
    """The left one, of the frame that is asked for; the first without."""
    uyvy = picture_of_file(thirds)
    grey = uyvy.copy()
    grey[:] = 128
    with RecordingWriter(tmp_path / "two.mcap", width=8, height=6) as writer:
        writer.add(uyvy, grey, 0, 0)
        writer.add(grey, uyvy, 1, 1)
    assert seen(tmp_path / "two.mcap") == seen(thirds)
    assert seen(tmp_path / "two.mcap", "--frame", 1) == {"white": 1.0}
    assert "--frame must be 0 to 1" in refused(tmp_path / "two.mcap", "--frame", 2)


def test_another_firmware_has_other_colours(thirds: Path, other: Path, tmp_path: Path) -> None:
    """Any number of them, with hues of its own; nothing of the built-in one is asked."""
    assert seen(thirds, "--firmware", f"{other}:halving") == {"left": 0.5, "right": 0.5}
    assert "plain must say what it calls the colours" in refused(thirds, "--firmware", f"{other}:plain")
    script = tmp_path / "many.json"
    script.write_text('{"number": 2}')
    called = (thirds, "--firmware", f"{other}:halving", "--script", script)
    assert "must name every number in its picture, up to 2, but names 2" in refused(*called)


def test_firmware_that_fails_is_told_with_its_line(other: Path, tmp_path: Path) -> None:
    """And numbers of another shape than the picture's are refused."""
    called = (RECORDING, "--firmware", f"{other}:halving")
    assert f"failed with ValueError: no such colour ({other}:7)" in refused(*called, "--frame", 3)
    assert "must return numbers of uint8 and of shape (240, 320), not uint8 of (6, 320)" in refused(*called)


@pytest.mark.parametrize(
    ("found", "said"),
    [
        ("numbers=numbers.tolist(), named=halves", "numbers of uint8 and of shape (6, 8), not a list"),
        ("numbers=numbers, named=('dark', 'bright')", "must name each by a NamedColour with red, green and"),
        (
            "numbers=numbers, named=(NamedColour(name='dark', colour='black'),)",
            "0 to 255, not NamedColour(name=",
        ),
        (
            "numbers=numbers, named=(NamedColour(name=None, colour=(0, 0, 0)),)",
            "0 to 255, not NamedColour(name=",
        ),
    ],
)
def test_what_is_no_colour_is_refused(thirds: Path, tmp_path: Path, found: str, said: str) -> None:
    """With what it must be: it ended in a traceback."""
    text = OTHER.replace(
        "halving = ",
        f"""
def odd(picture, script, frame):
    numbers, halves = picture[:, 1::2] // 128, (NamedColour(name="dark", colour=(0, 0, 0)),) * 2
    return PictureColours({found})

halving = """,
    ).replace("colours=halves", "colours=odd")
    (tmp_path / "odd.py").write_text(text)
    assert said in refused(thirds, "--firmware", f"{tmp_path / 'odd.py'}:halving")


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--frame", "0"), "--frame must go with a recording"),
        (("--grey", "4,4,20x20"), "--grey must lie in the picture of 8x6, not end at column 24 and row 24"),
        (("--grey", "here"), "must be left,top,width x height, such as 10,20,64x48, not 'here'"),
        (("--out", "out.jpg"), "--out must be a file *.png, not out.jpg"),
    ],
)
def test_what_cannot_be_is_refused(thirds: Path, options: tuple[str, ...], said: str) -> None:
    """Before anything is drawn."""
    assert said in refused(thirds, *options)


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    """A file that is not there, and one that is something else."""
    assert "must be a picture or a recording to be read: No such file" in refused(tmp_path / "none.png")
    (tmp_path / "text.png").write_text("text")
    assert "file must be an image that Pillow reads" in refused(tmp_path / "text.png")
