"""Overlays on the disk: whole or not at all, and nothing that is not ours is touched."""

from __future__ import annotations

import weakref
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from bfsim.errors import ConfigError
from bfsim.report.overlay import animations
from bfsim.report.overlay.animations import ENCODERS, FRAME_MS
from bfsim.report.overlay.files import OverlayWriter
from bfsim.seen import Seen
from tests import seen_frames as made
from tests.tiers import exhaustive


def draw(path: Path, *indices: int) -> None:
    """Write an overlay of frames of these numbers."""
    with OverlayWriter(path) as writer:
        for index in indices:
            writer.add(made.frame(index))


def names(folder: Path) -> list[str]:
    """All that is in a folder, hidden files included."""
    return sorted(each.name for each in folder.iterdir())


def test_a_folder_has_a_picture_per_frame(tmp_path: Path) -> None:
    """Named by the frame's number in the recording."""
    draw(tmp_path / "seen", 0, 7)
    assert names(tmp_path) == ["seen"]
    assert names(tmp_path / "seen") == ["frame-0000.png", "frame-0007.png"]
    with Image.open(tmp_path / "seen" / "frame-0007.png") as image:
        assert image.mode == "RGB"
        image.load()


def test_an_earlier_overlay_is_replaced_as_a_whole(tmp_path: Path) -> None:
    """No frame of a longer run before stays."""
    folder = tmp_path / "seen"
    folder.mkdir()
    draw(folder, 0, 1, 2)
    draw(folder, 1)
    assert names(folder) == ["frame-0001.png"]


@pytest.mark.parametrize("name", ["notes.txt", "frame-0000.png"])
def test_what_is_not_ours_is_refused(tmp_path: Path, name: str) -> None:
    """Even a picture with a name like ours."""
    Image.new("RGB", (2, 2)).save(tmp_path / name, "PNG")
    with pytest.raises(ConfigError, match=f"must be a new folder.*but holds {name}"):
        OverlayWriter(tmp_path)
    assert names(tmp_path) == [name]


def test_an_error_leaves_nothing(tmp_path: Path) -> None:
    """Neither half an overlay nor a draft; what was there before stays."""
    draw(tmp_path / "old", 0)
    for path in (tmp_path / "new", tmp_path / "old", tmp_path / "film.gif"):
        with pytest.raises(KeyboardInterrupt), OverlayWriter(path) as writer:
            writer.add(made.frame(5))
            raise KeyboardInterrupt
    assert names(tmp_path) == ["old"]
    assert names(tmp_path / "old") == ["frame-0000.png"]


@pytest.mark.parametrize("suffix", [".webp", ".apng"])
def test_an_animated_file_is_made_of_one_picture_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, suffix: str
) -> None:
    """Not of all of them at once: 100 took 860 MB as WebP, and 1.4 GB as APNG."""
    papers: list[weakref.ref[Image.Image]] = []
    alive, blank = [], Image.new

    def new(*arguments: Any) -> Image.Image:
        alive.append(sum(each() is not None for each in papers))
        image = blank(*arguments)
        papers.append(weakref.ref(image))
        return image

    pictures = []
    for number in range(9):
        pictures.append(tmp_path / f"{number}.png")
        Image.effect_noise((64, 32), 50 + number).convert("RGB").save(pictures[-1])
    monkeypatch.setattr(animations.Image, "new", new)
    ENCODERS[suffix](pictures, tmp_path / f"film{suffix}")
    assert len(alive) >= 9
    assert max(alive) <= 2


@pytest.mark.parametrize("suffix", [".gif", *exhaustive(".webp", ".apng")])
def test_an_animated_file_shows_all_frames(tmp_path: Path, suffix: str) -> None:
    """One after the other, for ever; an earlier file is replaced."""
    path = tmp_path / f"seen{suffix}"
    draw(path, 0)
    draw(path, 0, 1, 2)
    assert names(tmp_path) == [path.name]
    with Image.open(path) as image:
        assert getattr(image, "n_frames", 1) == 3
        assert image.info["loop"] == 0
        image.seek(1)
        image.load()
        assert image.info["duration"] == FRAME_MS


def test_a_video_shows_all_frames(tmp_path: Path) -> None:
    """Frames of an odd height and of other sizes fit in."""
    av = pytest.importorskip("av")
    path = tmp_path / "seen.mp4"
    draw(path, 0)
    small = Seen(camera="left", picture=made.grey(46, 11))
    with OverlayWriter(path) as writer:
        for cameras in ((small,), ()):
            writer.add(made.frame(0 if cameras else 1, *cameras))
    with av.open(str(path)) as video:
        decoded = [(each.width, each.height, each.time) for each in video.decode(video=0)]
    assert [time for _, _, time in decoded] == [0, FRAME_MS / 1000]
    assert {size[:2] for size in decoded} == {(2540, 810)}


def test_places_that_cannot_be_are_refused_before_the_run(tmp_path: Path) -> None:
    """A format that nothing writes, a file in the place of the folder, a folder nowhere."""
    with pytest.raises(ConfigError, match=r"must be a folder or a file \*\.gif, .*, not .*seen\.jpg"):
        OverlayWriter(tmp_path / "seen.jpg")
    (tmp_path / "drive.mp4").write_text("the film that became the recording")
    with pytest.raises(ConfigError, match="must be a new file or an earlier overlay, not another file"):
        OverlayWriter(tmp_path / "drive.mp4")
    (tmp_path / "file").write_text("text")
    with pytest.raises(ConfigError, match="must be a folder for the overlay, not a file"):
        OverlayWriter(tmp_path / "file")
    for name in ("seen", *(f"seen{suffix}" for suffix in ENCODERS)):
        with pytest.raises(ConfigError, match="missing must exist"):
            OverlayWriter(tmp_path / "missing" / name)


def test_a_file_of_no_pictures_is_refused(tmp_path: Path) -> None:
    """The view of a firmware may show nothing in any frame: it ended in a traceback."""
    with (
        pytest.raises(ConfigError, match=r"seen\.gif: there is nothing to draw: the firmware's view has"),
        OverlayWriter(tmp_path / "seen.gif"),
    ):
        pass
    assert not [*tmp_path.iterdir()]
