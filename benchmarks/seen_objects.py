"""The objects that the firmware sees in a recording: its stages on a simulated board, and what each leaves in memory."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.playing import play
from bfsim.api import Core, Firmware, Readout
from bfsim.recording import RecordingReader
from bfsim.running.inputs import calibration_of
from tinyphoon import ROWS, TABLE_6_4
from tinyphoon.buffers import buffers, calibration_buffers
from tinyphoon.features import features
from tinyphoon.stages.object_detection import left_sight, object_detection, right_sight
from tinyphoon.stores.objects import NO_MODEL, OBJECT_MODEL, OBJECT_WORDS
from tinyphoon.strategy.models import model_words
from tinyphoon.strategy.modes import INDOOR_FIELD, Mode
from tinyphoon.strategy.report import report
from tinyphoon.strategy_unit.decoding import Results, decode_results
from tinyphoon.strategy_unit.messages import decode, message_nbytes

Records = NDArray[np.int16]
"""Rows of t_Object."""


@dataclass(frozen=True, slots=True)
class Seen:
    """One frame: the objects that each camera sees by itself, the message that left, and what is true."""

    left: Records
    right: Records
    results: Results
    truth: Mapping[str, Any]


def see(path: Path, mode: Mode = INDOOR_FIELD, frames: int | None = None) -> list[Seen]:
    """Return what the firmware sees in the frames of a recording, the first `frames` of them."""
    alone: dict[str, list[Records]] = {"A": [], "B": []}

    def keep(core: Core, name: str) -> None:
        records = core.array(name).array.reshape(-1, OBJECT_WORDS)
        alone[core.name].append(records[records[:, OBJECT_MODEL] != NO_MODEL].copy())

    def left_main(core: Core) -> Generator[Any, Any, None]:
        core.array("models").array[:] = model_words(mode.models)
        while (frame := (yield from core.next_frame())) is not None:
            found = yield from features(core, frame, mode)
            yield from left_sight(core, frame, found.outlines, mode.objects)
            keep(core, "left_seen")
            yield from core.wait("core B is done")
            yield from object_detection(core, frame, mode.objects)
            yield from core.post("core A is done")
            yield from report(core, frame)

    def right_main(core: Core) -> Generator[Any, Any, None]:
        core.array("models").array[:] = model_words(mode.models)
        while (frame := (yield from core.next_frame())) is not None:
            found = yield from features(core, frame, mode)
            yield from right_sight(core, frame, found.outlines, mode.objects)
            keep(core, "right_seen")
            yield from core.post("core B is done")
            yield from core.wait("core A is done")

    plain = Firmware(
        mains={"A": left_main, "B": right_main},
        buffers=buffers,
        camera="camera",
        rows=ROWS,
        reference=TABLE_6_4,
        calibration=calibration_buffers,
    )
    with RecordingReader(path) as reader:
        pictures = list(reader.frames(min(frames or reader.frame_count, reader.frame_count)))
        played = play(pictures, plain.calibrated(calibration_of(reader)), _payload)
    truths = [each.truth or {} for each in pictures]
    results = [decode_results(each.taken["A"]) for each in played]
    return [Seen(*each) for each in zip(alone["A"], alone["B"], results, truths, strict=True)]


def _payload(readout: Readout) -> bytes:
    """The message of core A that has just left; core B sends none."""
    if readout.core != "A":
        return b""
    message = readout.values("results")
    return decode(message.tobytes()[: message_nbytes(int(message[3]))]).payload
