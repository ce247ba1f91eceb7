"""Sets of real pictures as stereo frames: those of a folder with known names, any other folder of pictures, and recordings.

A folder is a *pair* if it holds a left and a right picture whose names say so (`aloeL` and `aloeR`, `imL2l` and `imL2`,
`motorcycle_left` and `_right`), with true disparities beside them or without; else every picture in it is seen by both
cameras. Pictures are scaled to the width that the recording shall have, their middle cut to 4:3, as `record import
--resize` does. A recording is seen as it is, with its rectification tables and geometry.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.machine.program import Calibration
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.planes import YuvPlanes
from bfsim.running.inputs import calibration_of

Disparities = NDArray[np.float64]
"""Of each pixel of the left picture, in pixels of that picture; NaN where unknown."""

PICTURES = {".png", ".jpg", ".jpeg", ".bmp", ".ppm", ".tif", ".tiff"}
VIDEOS = {".avi", ".mp4", ".mkv", ".mov"}
SIZE = (320, 240)
FRAMES_OF_VIDEO = 8
UNKNOWN = Calibration()


@dataclass(frozen=True, slots=True)
class PictureSet:
    """Pictures of one kind. `frames`: stereo frames of equal size. `truth`: disparities of each frame, where they are known.

    `calibration`: what is known of their cameras.
    """

    name: str
    frames: tuple[StereoFrame, ...]
    is_stereo: bool
    truth: tuple[Disparities, ...] = ()
    calibration: Calibration = UNKNOWN

    def lumas(self, frame: StereoFrame) -> list[NDArray[np.uint8]]:
        """Return the grey pictures of a frame, rectified; black where a camera saw nothing."""
        sources = self.calibration.sources
        recorded = {"A": frame.left[:, 1::2], "B": frame.right[:, 1::2]}
        return [
            np.where(sources[core].rows < 0, 0, luma[sources[core].rows, sources[core].columns])
            if core in sources
            else np.ascontiguousarray(luma)
            for core, luma in recorded.items()
        ]


def read_recording(path: Path) -> PictureSet:
    """Return the frames of a recording."""
    with RecordingReader(path) as reader:
        frames = tuple(reader.frames())
        calibration = calibration_of(reader)
    is_stereo = any((each.left != each.right).any() for each in frames)
    return PictureSet(path.stem, frames, is_stereo, calibration=calibration)


def read_set(folder: Path, size: tuple[int, int] = SIZE) -> PictureSet:
    """Return the pictures of a folder, scaled to `size`."""
    pair = _pair_of(folder)
    if pair:
        left, right, truth = pair
        pictures = tuple(_scaled(Image.open(each), size) for each in (left, right))
        disparities = (_scaled_disparities(truth(), size),) if truth else ()
        return PictureSet(folder.name, (_frame(0, *pictures),), is_stereo=True, truth=disparities)
    files = sorted(each for each in folder.iterdir() if each.is_file())
    lefts = [each for each in files if each.stem.startswith("left") and each.suffix in PICTURES]
    rights = [each for each in files if each.stem.startswith("right") and each.suffix in PICTURES]
    if lefts and len(lefts) == len(rights):
        pairs = [(_open(one, size), _open(other, size)) for one, other in zip(lefts, rights, strict=True)]
    else:
        pairs = [(one, one) for path in files for one in _pictures(path, size)]
    frames = tuple(_frame(number, *pictures) for number, pictures in enumerate(pairs))
    return PictureSet(folder.name, frames, is_stereo=False)


def _open(path: Path, size: tuple[int, int]) -> Image.Image:
    return _scaled(Image.open(path), size)


def _pictures(path: Path, size: tuple[int, int]) -> Sequence[Image.Image]:
    """Return the pictures of a file: one, or some of a video, evenly spread; none of any other file."""
    if path.suffix.lower() in PICTURES:
        return [_open(path, size)]
    if path.suffix.lower() not in VIDEOS:
        return []
    video = cv2.VideoCapture(str(path))
    found = []
    while (read := video.read())[0]:
        found.append(Image.fromarray(cv2.cvtColor(read[1], cv2.COLOR_BGR2RGB)))
    chosen = found[:: max(1, len(found) // FRAMES_OF_VIDEO)][:FRAMES_OF_VIDEO]
    return [_scaled(each, size) for each in chosen]


def _scaled(picture: Image.Image, size: tuple[int, int]) -> Image.Image:
    """Cut the middle of a picture to the shape of `size`, and scale it by its area."""
    wide, high = picture.size
    width, height = size
    part = min(wide / width, high / height)
    left, top = (wide - part * width) / 2, (high - part * height) / 2
    box = (round(left), round(top), round(left + part * width), round(top + part * height))
    return (
        picture.convert("RGB")
        .crop(box)
        .resize(size, Image.Resampling.BOX if part > 1 else Image.Resampling.BILINEAR)
    )


def _scaled_disparities(full: Disparities, size: tuple[int, int]) -> Disparities:
    """Cut and scale a disparity map as the picture that it is of; disparities shrink with it."""
    high, wide = full.shape
    width, height = size
    part = min(wide / width, high / height)
    left, top = (wide - part * width) / 2, (high - part * height) / 2
    rows = np.clip((top + part * (np.arange(height) + 0.5)).astype(int), 0, high - 1)
    columns = np.clip((left + part * (np.arange(width) + 0.5)).astype(int), 0, wide - 1)
    return full[np.ix_(rows, columns)] / part


def _frame(number: int, left: Image.Image, right: Image.Image) -> StereoFrame:
    coded = [YuvPlanes.from_image(each).to_uyvy() for each in (left, right)]
    at_ns = number * 33_333_333
    return StereoFrame(number, *coded, left_ns=at_ns, right_ns=at_ns, truth=None)


Truth = Callable[[], Disparities] | None


def _pair_of(folder: Path) -> tuple[Path, Path, Truth] | None:
    """Return left picture, right picture and what reads the true disparities of a folder with one stereo pair."""
    for left, right, truth in (
        ("aloeL.jpg", "aloeR.jpg", lambda: _grey(folder / "aloeGT.png", 1)),
        ("imL2l.bmp", "imL2.bmp", lambda: _grey(folder / "groundtruth.bmp", 16)),
        ("motorcycle_left.png", "motorcycle_right.png", lambda: _array(folder / "motorcycle_disp.npz")),
        ("im0.png", "im1.png", None),
        ("left.png", "right.png", None),
    ):
        if (folder / left).exists() and (folder / right).exists():
            return folder / left, folder / right, truth
    return None


def _grey(path: Path, units: int) -> Disparities:
    """Read disparities that are stored as grey levels, `units` a pixel; 0 is unknown."""
    levels = np.asarray(Image.open(path).convert("L"), np.float64)
    return np.where(levels > 0, levels / units, np.nan)


def _array(path: Path) -> Disparities:
    with np.load(path) as kept:
        found = np.asarray(kept[kept.files[0]], np.float64)
    return np.where(np.isfinite(found), found, np.nan)
