"""Which pictures of folders, patterns and files go together: by their numbers and names, and what is left out is listed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording import (
    RecordingReader,
    StereoGeometry,
)
from bfsim.recording.importing.importer import SAME_PICTURES, import_recording
from tests.recording.pictures import animation, frames_of, save_grey


def test_pictures_of_one_camera_alone_are_skipped_and_listed(tmp_path: Path) -> None:
    """Frames that either camera missed: the others go together by their numbers."""
    for side, numbers in (("left", (1, 2, 3, 5)), ("right", (2, 4, 5))):
        for number in numbers:
            save_grey(tmp_path / side / f"{side}_{number}.png", 10 * number + (side == "right"))
    made = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    levels = [(each.left[0, 1], each.right[0, 1]) for each in frames_of(tmp_path / "a.mcap")]
    assert levels == [(20, 21), (50, 51)]
    assert [each.name for each in made.skipped] == ["left/left_1.png", "left/left_3.png", "right/right_4.png"]
    assert {each.reason for each in made.skipped} == {"has no picture of the other camera"}


def test_two_folders_in_natural_order(tmp_path: Path) -> None:
    """Image 2 comes before image 10, other files are no images, and grey has no colour."""
    for k in (1, 2, 10):
        save_grey(tmp_path / "left" / f"im{k}.png", k)
        save_grey(tmp_path / "right" / f"im{k}.bmp", 100 + k)
    (tmp_path / "left" / "im1.txt").write_text("a label")
    geometry = StereoGeometry(386, 30, 60, 20)
    summary = import_recording(
        [tmp_path / "left", tmp_path / "right"],
        tmp_path / "a.mcap",
        fps=25,
        geometry=geometry,
        description="x",
    )
    assert (summary.width, summary.height, summary.frame_count, summary.fps) == (8, 4, 3, 25)
    frames = frames_of(tmp_path / "a.mcap")
    assert [frame.left[0].tolist() for frame in frames] == [[128, k] * 8 for k in (1, 2, 10)]
    assert [frame.right[3, 1] for frame in frames] == [101, 102, 110]
    assert [(frame.left_ns, frame.right_ns) for frame in frames] == [(k * 40_000_000,) * 2 for k in range(3)]
    with RecordingReader(tmp_path / "a.mcap") as reader:
        assert (reader.geometry, reader.description) == (geometry, "x")


def test_what_a_browser_saves_again_comes_behind_the_first(tmp_path: Path) -> None:
    """`IMG (1).png` behind `IMG.png`, though a space comes before a dot."""
    for level, name in enumerate(["IMG", "IMG (1)", "IMG (2)", "IMG (10)"]):
        save_grey(tmp_path / "one" / f"{name}.png", level)
    import_recording([tmp_path / "one"], tmp_path / "a.mcap", mono=True)
    assert [frame.left[0, 1] for frame in frames_of(tmp_path / "a.mcap")] == [0, 1, 2, 3]


def test_pictures_of_one_camera_twice_are_told(tmp_path: Path) -> None:
    """Under other names; once they differ in a byte of any frame they are two cameras'."""
    for k in range(2):
        for side in ("left", "right"):
            save_grey(tmp_path / side / f"{k}.png", k)
    sources = [tmp_path / "left", tmp_path / "right"]
    assert import_recording(sources, tmp_path / "a.mcap").notes == (SAME_PICTURES,)
    save_grey(tmp_path / "right" / "1.png", 2)
    assert not import_recording(sources, tmp_path / "b.mcap").notes


def test_pattern_and_single_files(tmp_path: Path) -> None:
    """Left and right images may share a folder, picked by pattern or one by one."""
    for k in range(2):
        save_grey(tmp_path / "both" / f"l{k}.png", k)
        save_grey(tmp_path / "both" / f"r{k}.png", 10 + k)
    import_recording([tmp_path / "both" / "l*.png", tmp_path / "both" / "r*.png"], tmp_path / "a.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames_of(tmp_path / "a.mcap")] == [
        (0, 10),
        (1, 11),
    ]
    import_recording([tmp_path / "both" / "l1.png", tmp_path / "both" / "r0.png"], tmp_path / "b.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames_of(tmp_path / "b.mcap")] == [(1, 10)]


def test_side_by_side(tmp_path: Path) -> None:
    """The left half of each picture is the left camera's."""
    halves = np.hstack([np.full((4, 8), 10, np.uint8), np.full((4, 8), 200, np.uint8)])
    save_grey(tmp_path / "im" / "0.png", 0)
    Image.fromarray(halves).save(tmp_path / "im" / "0.png")
    summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", side_by_side=True)
    assert (summary.width, summary.height) == (8, 4)
    (frame,) = frames_of(tmp_path / "a.mcap")
    assert set(frame.left[:, 1::2].flat) == {10}
    assert set(frame.right[:, 1::2].flat) == {200}


def test_gifs_in_a_folder_are_pictures(tmp_path: Path) -> None:
    """They were passed over by their name; an animation among them is none, as any file of several pictures."""
    for side in ("left", "right"):
        (tmp_path / side).mkdir()
        for number, level in enumerate((10, 200)):
            Image.new("L", (8, 4), level).save(tmp_path / side / f"{number}.gif")
        animation(tmp_path / side / "9.gif", "GIF")
    summary = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    assert [frame.left[0, 1] for frame in frames_of(tmp_path / "a.mcap")] == [10, 200]
    assert {each.name for each in summary.skipped} == {"9.gif"}
    assert summary.skipped[0].reason.startswith("image must be one picture, not 3")


@pytest.mark.parametrize(("name", "format"), [("a.png", "PNG"), ("a.webp", "WEBP"), ("a.tiff", "TIFF")])
def test_a_picture_of_several_is_refused(tmp_path: Path, name: str, format: str) -> None:
    """The first one came, and the others were lost without a word."""
    animation(tmp_path / name, format)
    with pytest.raises(
        RecordingError, match=r"a\.\w+: image must be one picture, not 3; `--format video` reads"
    ):
        import_recording([tmp_path / name], tmp_path / "a.mcap", mono=True)


def test_a_picture_that_a_decoder_stumbles_over_is_skipped(tmp_path: Path) -> None:
    """Pillow raises a TypeError of a TIFF with a number of another type, which ended the import."""
    for name in ("bad.tif", "whole.tif"):
        save_grey(tmp_path / "im" / name, 7)
    damaged = bytearray((tmp_path / "im" / "bad.tif").read_bytes())
    damaged[72] = 2
    (tmp_path / "im" / "bad.tif").write_bytes(damaged)
    summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", mono=True)
    assert summary.frame_count == 1
    assert [each.name for each in summary.skipped] == ["bad.tif"]
    assert summary.skipped[0].reason.startswith("image must be whole, but Pillow stops in it (TypeError: ")


def test_a_jpeg_with_a_copy_behind_it_is_one_picture(tmp_path: Path) -> None:
    """Phones put a smaller copy behind the picture."""
    animation(tmp_path / "a.jpg", "MPO")
    assert import_recording([tmp_path / "a.jpg"], tmp_path / "a.mcap", mono=True).frame_count == 1


def test_mixed_sizes_and_stray_files(tmp_path: Path) -> None:
    """Upright and lying pictures come to one size; what is no picture is listed, and takes no frame."""
    (tmp_path / "im").mkdir()
    save_grey(tmp_path / "im" / "0.png", 10, (30, 40))
    save_grey(tmp_path / "im" / "1.png", 20, (64, 48))
    save_grey(tmp_path / "im" / "3.png", 30, (7, 5))
    (tmp_path / "im" / "2.png").write_text("no image")
    (tmp_path / "im" / "notes.txt").write_text("a label")
    for fit, levels in (({"resize": (8, 6)}, [10, 20, 30]), ({"crop": (8, 6)}, [10, 20])):
        summary = import_recording([tmp_path / "im"], tmp_path / "a.mcap", mono=True, force=True, **fit)
        frames = frames_of(tmp_path / "a.mcap")
        assert [set(frame.left[:, 1::2].flat) for frame in frames] == [{level} for level in levels]
        assert [frame.left_ns for frame in frames] == [round(k * 1e9 / 30) for k in range(len(levels))]
        assert [each.name for each in summary.skipped][:2] == ["notes.txt", "2.png"]
    assert summary.skipped[2].reason.startswith("7x5 is too small for `--crop` 8x6")
    assert summary.source_sizes == ((30, 40), (64, 48))


def test_one_bad_picture_takes_its_pair_along(tmp_path: Path) -> None:
    """What follows stays with its own partner."""
    for k in range(3):
        save_grey(tmp_path / "left" / f"{k}.png", k)
        save_grey(tmp_path / "right" / f"{k}.png", 100 + k)
    (tmp_path / "left" / "0.png").write_bytes(b"")
    summary = import_recording([tmp_path / "left", tmp_path / "right"], tmp_path / "a.mcap")
    frames = frames_of(tmp_path / "a.mcap")
    assert [(frame.left[0, 1], frame.right[0, 1]) for frame in frames] == [(1, 101), (2, 102)]
    assert [each.name for each in summary.skipped] == ["0.png"]


def test_a_link_that_leads_nowhere_is_a_picture_that_cannot_be_read(tmp_path: Path) -> None:
    """Data sets kept by git-annex have those where a picture was not fetched."""
    save_grey(tmp_path / "left" / "0.png", 1)
    (tmp_path / "left" / "1.png").symlink_to("nowhere.png")
    (tmp_path / "left" / "2.png").symlink_to(tmp_path / "left" / "2.png")
    summary = import_recording([tmp_path / "left"], tmp_path / "a.mcap", mono=True)
    assert summary.frame_count == 1
    assert [each.name for each in summary.skipped] == ["1.png", "2.png"]
    assert "No such file" in summary.skipped[0].reason


def test_a_pattern_in_a_folder_with_brackets(tmp_path: Path) -> None:
    """Brackets of a folder that is there are its name; those of the rest are a pattern."""
    for k in (1, 2, 3):
        save_grey(tmp_path / "run [1]" / f"left_{k}.png", k)
    import_recording([str(tmp_path / "run [1]" / "left_[12].png")], tmp_path / "a.mcap", mono=True)
    assert [frame.left[0, 1] for frame in frames_of(tmp_path / "a.mcap")] == [1, 2]
