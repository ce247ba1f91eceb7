"""Imports of bags, and what comes of them."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from bfsim.cli.record import record
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.recording.importing.importer import import_recording
from tests.recording.bags import (
    KINDS,
)

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
each_kind = pytest.mark.parametrize("kind", KINDS)


def imported(path: Path, **how: object) -> list[StereoFrame]:
    """The frames that an import makes of a bag."""
    output = path.parent / "out.mcap"
    import_recording([path], output, force=True, **how)
    with RecordingReader(output) as reader:
        return list(reader.frames())


def greys(frames: list[StereoFrame]) -> list[tuple[int, int]]:
    """Brightness of the left and the right picture of each frame."""
    return [(int(each.left[0, 1]), int(each.right[0, 1])) for each in frames]


def run(*arguments: object) -> Result:
    """Run `bfsim record`."""
    return CliRunner().invoke(record, [str(each) for each in arguments])
