"""Grey images whose pixels are behind a pattern of colours: told, and made colours of; real grey pictures are not told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.mosaic import is_mosaic
from tests.recording.pictures import frames_of

WIDTH, HEIGHT = 64, 48


def picture() -> np.ndarray:
    """Return a smooth picture of many colours, a little noisy: (48, 64, 3)."""
    rng = np.random.default_rng(1)
    rough = Image.fromarray(rng.integers(0, 256, (6, 8, 3), np.uint8)).resize(
        (WIDTH, HEIGHT), Image.Resampling.BILINEAR
    )
    return np.clip(np.asarray(rough) + rng.normal(0, 2, (HEIGHT, WIDTH, 3)), 0, 255).astype(np.uint8)


def mosaic(colours: np.ndarray) -> np.ndarray:
    """Return what a sensor with a pattern of red, green; green, blue sees of a picture."""
    seen = colours[..., 1].copy()
    seen[::2, ::2], seen[1::2, 1::2] = colours[::2, ::2, 0], colours[1::2, 1::2, 2]
    return seen


def notes(tmp_path: Path, pixels: np.ndarray, **options: object) -> tuple[str, ...]:
    """Return what is said of an import of an image, to `a.mcap`."""
    Image.fromarray(pixels).save(tmp_path / "a.png")
    output = tmp_path / "a.mcap"
    return import_recording([tmp_path / "a.png"], output, mono=True, force=True, **options).notes  # type: ignore[arg-type]


def test_a_mosaic_is_told_and_neither_a_grey_picture_nor_a_coloured_one(tmp_path: Path) -> None:
    colours = picture()
    assert any("`--format bayer_rggb8`" in each for each in notes(tmp_path, mosaic(colours)))
    assert not any("bayer" in each for each in notes(tmp_path, colours[..., 1]))
    assert not any("bayer" in each for each in notes(tmp_path, colours))


@pytest.mark.parametrize(
    "pixels",
    [
        np.zeros((8, 8), np.uint8),
        np.full((1, 1), 7, np.uint8),
        np.random.default_rng(2).integers(0, 256, (HEIGHT, WIDTH), np.uint8),
        np.tile(np.arange(WIDTH, dtype=np.uint8), (HEIGHT, 1)),
        np.tile(np.array([0, 200], np.uint8), (HEIGHT, WIDTH // 2)),
        np.array([[3, 9], [9, 40]], np.uint8),
        np.tile(np.array([[0, 255], [255, 0]], np.uint8), (HEIGHT // 2, WIDTH // 2)),
    ],
    ids=["black", "a pixel", "noise", "a ramp", "upright lines", "four pixels", "black and white, dithered"],
)
def test_what_has_no_pattern_of_colours_is_none(pixels: np.ndarray) -> None:
    assert not is_mosaic(pixels)


def test_its_colours_are_those_of_the_picture(tmp_path: Path) -> None:
    """But for what lies between two pixels of a colour."""
    pytest.importorskip("cv2")
    colours = picture()
    notes(tmp_path, colours)
    (expected,) = frames_of(tmp_path / "a.mcap")
    assert notes(tmp_path, mosaic(colours), format="bayer_rggb8") == ()
    (found,) = frames_of(tmp_path / "a.mcap")
    apart = np.abs(found.left.astype(int) - expected.left)[2:-2, 8:-8]
    assert np.mean(apart) < 3
    notes(tmp_path, mosaic(colours), format="bayer_bggr8")
    (wrong,) = frames_of(tmp_path / "a.mcap")
    assert np.mean(np.abs(wrong.left.astype(int) - expected.left)) > 10


def test_two_folders_are_paired_and_mistakes_told(tmp_path: Path) -> None:
    pytest.importorskip("cv2")
    for side, names in (("left", "12"), ("right", "23")):
        (tmp_path / side).mkdir()
        for name in names:
            Image.fromarray(mosaic(picture())).save(tmp_path / side / f"{side}{name}.png")
    folders = [tmp_path / "left", tmp_path / "right"]
    summary = import_recording(folders, tmp_path / "two.mcap", format="bayer_rggb8")
    assert (summary.frame_count, summary.width) == (1, WIDTH)
    with pytest.raises(RecordingError, match="`--size` must go with raw frames"):
        import_recording(folders, tmp_path / "b.mcap", format="bayer_rggb8", size=(64, 48))
    with pytest.raises(RecordingError, match="image must be grey for `--format bayer_rggb8`, not .* RGB"):
        notes(tmp_path, picture(), format="bayer_rggb8")
