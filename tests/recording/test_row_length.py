"""Raw frames whose rows are not as long as `--size` says: told by their pixels, and never of right ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bfsim.recording import RecordingReader
from bfsim.recording.importing.importer import import_recording
from bfsim.recording.importing.row_length import other_row_length
from bfsim.shipped import RECORDING
from tests.recording.pictures import noise


def soccer() -> np.ndarray:
    """Return the brightness of a built-in picture, 240 x 320."""
    with RecordingReader(RECORDING) as reader:
        return next(reader.frames(1)).left[:, 1::2]


@pytest.mark.parametrize("width", [160, 240, 300, 400, 640, 960])
def test_another_length_is_told_with_the_right_one(width: int) -> None:
    """Shorter and longer ones, and those that hold two or three rows side by side."""
    pixels = soccer().ravel()
    rows = len(pixels) // width
    assert other_row_length(pixels[: rows * width].reshape(rows, width)) == 320


@pytest.mark.parametrize(
    "picture",
    [
        soccer(),
        noise((240, 320)),
        np.full((240, 320), 99, np.uint8),
        np.tile(np.arange(320, dtype=np.uint8), (240, 1)),
        np.tile(np.repeat(np.arange(8, dtype=np.uint8) % 2 * 255, 40), (240, 1)),
        noise((4, 8)),
    ],
    ids=["soccer", "noise", "flat", "equal rows", "stripes", "tiny"],
)
def test_of_a_right_length_nothing_is_said(picture: np.ndarray) -> None:
    """Nor where nothing tells what it is."""
    assert other_row_length(picture) is None


def test_an_import_tells_of_it(tmp_path: Path) -> None:
    """Twelve frames of 320x240 came of three of 640x480, without a word."""
    (tmp_path / "a.grey").write_bytes(soccer().repeat(2, axis=0).repeat(2, axis=1).tobytes())
    wrong, right = (
        import_recording([tmp_path / "a.grey"], tmp_path / f"{size[0]}.mcap", mono=True, size=size).notes
        for size in ((320, 240), (640, 480))
    )
    assert [each.split(": ")[2][:59] for each in wrong] == [
        "rows seem to be 640 pixels long, not 320, as rows are then "
    ]
    assert not right
