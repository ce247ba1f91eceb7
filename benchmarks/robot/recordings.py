"""Other recordings made of a scene's: smaller, black, with tables that rectify it, or of cameras that run free."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image

from bfsim.api import SourcePixels
from bfsim.machine.cameras.skipping import skipped
from bfsim.recording import RecordingReader
from bfsim.recording.frames import RectificationTables
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.writer import RecordingWriter

PICTURES_SHOWN = 12
"""Of each frame of a scene, where the cameras run free: more than come in while one is worked on."""


@contextmanager
def like(
    recording: Path, made: Path, *, halvings: int = 0, rectification: RectificationTables | None = None
) -> Iterator[tuple[RecordingReader, RecordingWriter]]:
    """Open a recording, and one to be made of it, of the same cameras, with width and height halved so often."""
    with RecordingReader(recording) as reader:
        size = {"width": reader.width >> halvings, "height": reader.height >> halvings}
        with RecordingWriter(made, **size, geometry=reader.geometry, rectification=rectification) as writer:
            yield reader, writer


def halve(recording: Path, smaller: Path) -> None:
    """Write a recording of half the width and height, as a sensor skips pixels."""
    with like(recording, smaller, halvings=1) as (reader, writer):
        for frame in reader.frames():
            pictures = (skipped(each, 2) for each in (frame.left, frame.right))
            writer.add(*pictures, frame.left_ns, frame.right_ns)


def write_black(recording: Path, black: Path) -> None:
    """Write a recording of as many black pictures."""
    with like(recording, black) as (reader, writer):
        picture = YuvPlanes.from_image(Image.new("RGB", (reader.width, reader.height))).to_uyvy()
        for frame in reader.frames():
            writer.add(picture, picture, frame.left_ns, frame.right_ns)


def write_rectified(recording: Path, rectified: Path, tables: Mapping[str, SourcePixels]) -> None:
    """Write a recording with the tables of its "left" and its "right" camera."""
    places = {side: np.stack([each.rows, each.columns]).astype(np.int32) for side, each in tables.items()}
    with like(recording, rectified, rectification=RectificationTables(**places)) as (reader, writer):
        for frame in reader.frames():
            writer.add(frame.left, frame.right, frame.left_ns, frame.right_ns)


def write_free(recording: Path, free: Path) -> None:
    """Write a recording in which every frame stands for some pictures, as where cameras go on while a robot thinks.

    Its time stamps only count: the pace is that of the cameras.
    """
    with like(recording, free) as (reader, writer):
        shown = (frame for frame in reader.frames() for _ in range(PICTURES_SHOWN))
        for number, frame in enumerate(shown):
            writer.add(frame.left, frame.right, number, number)
