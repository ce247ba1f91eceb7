"""Raw frames that are not as high as `--size` says: told by where pictures end, and never of right ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.row_count import wrong_row_count
from tests.recording.pictures import noise

WIDTH, HEIGHT = 320, 240


def film() -> np.ndarray:
    """Return eight pictures in UYVY, rough and each another one: (count, 240, 640)."""

    def rough(seed: int) -> Image.Image:
        return Image.fromarray(np.random.default_rng(seed).integers(0, 256, (30, 80), np.uint8))

    pictures = [np.asarray(rough(seed).resize((2 * WIDTH, HEIGHT))) for seed in range(8)]
    return np.stack(pictures)


def i420(uyvy: np.ndarray) -> np.ndarray:
    """Return pictures with the planes Y, U and V, one after the other."""
    planes = uyvy[..., 1::2], uyvy[:, ::2, 0::4], uyvy[:, ::2, 2::4]
    return np.concatenate([each.reshape(len(uyvy), -1) for each in planes], axis=1)


PICTURES = {
    "a.grey": film()[..., 1::2],
    "a.uyvy": film(),
    "a.yuyv": film().reshape(-1, 2)[:, ::-1],
    "a.i420": i420(film()),
}


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize(
    ("height", "said"),
    [
        (HEIGHT, None),
        (HEIGHT // 2, "they go on in the next ones"),
        (HEIGHT * 4 // 3, "they go on in the next ones"),
        (2 * HEIGHT, "another picture begins at a half of them"),
    ],
)
def test_an_import_tells_of_another_height(tmp_path: Path, name: str, height: int, said: str | None) -> None:
    """In any order of bytes; the file is a whole number of such frames, too."""
    file = tmp_path / name
    file.write_bytes(PICTURES[name].tobytes())
    notes = import_recording([file], tmp_path / "a.mcap", mono=True, size=(WIDTH, height)).notes
    expected = f"Warning: {file}: frames seem not to be {height} rows high: {said}; is `--size` right?"
    assert notes == (() if said is None else (expected,))


@pytest.mark.parametrize(
    "frames",
    [noise((4, 240, 320)), np.full((4, 240, 320), 99, np.uint8), noise((1, 240, 320)), noise((2, 4, 8))],
    ids=["noise", "flat", "one", "tiny"],
)
def test_nothing_is_said_where_nothing_tells(frames: np.ndarray) -> None:
    """Rows that are not alike inside a picture either, or that have no details."""
    count, height, width = frames.shape
    assert wrong_row_count(frames.reshape(count, -1), width, height) == ""
