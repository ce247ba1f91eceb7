"""Small pictures to be imported, and the frames that come of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from bfsim.recording import (
    RecordingReader,
    StereoFrame,
)


def frames_of(path: Path) -> list[StereoFrame]:
    """Return all frames of a recording."""
    with RecordingReader(path) as reader:
        return list(reader.frames())


def save_grey(path: Path, level: int, size: tuple[int, int] = (8, 4)) -> None:
    """Save an image of one grey level."""
    path.parent.mkdir(exist_ok=True)
    Image.new("L", size, level).save(path)


def noise(shape: tuple[int, ...], seed: int = 0) -> np.ndarray:
    """Return random bytes."""
    return np.random.default_rng(seed).integers(0, 256, shape, dtype=np.uint8)


def animation(path: Path, format: str) -> None:
    """Write three pictures that differ."""
    pictures = [Image.fromarray(each) for each in noise((3, 4, 8, 3))]
    pictures[0].save(path, format, save_all=True, append_images=pictures[1:], duration=100)
