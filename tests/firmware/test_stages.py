"""The stages on the simulated machine: whole pictures in SDRAM and the edge store, bit for bit against numpy."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.api import Core, Firmware
from bfsim.errors import LinkError
from bfsim.recording import RecordingReader
from bfsim.running.inputs import calibration_of
from bfsim.shipped import RECORDING
from tests.firmware.lenses import rectified, sighted
from tests.firmware.pictures import EXTREMES
from tests.firmware.whole_pictures import (
    board_for,
    buffer,
    check_core,
    check_edges,
    check_last_frame,
    random_frames,
    run,
    stereo,
)
from tests.tiers import exhaustive
from tinyphoon import fast, thesis, tinyphoon
from tinyphoon.areas import WHOLE_PICTURE
from tinyphoon.stages.edge_detection import edge_detection
from tinyphoon.stages.fast_scan import fast_edge_detection
from tinyphoon.stages.rosenfeld_hysteresis import rosenfeld_edges
from tinyphoon.stores.edges import EDGE_CAPACITY
from tinyphoon.strategy.modes import INDOOR_FIELD

BOTH = pytest.mark.parametrize("firmware", [tinyphoon, *exhaustive(fast)], ids=["plain", "fast"])
"""The fast steps leave what the plain ones leave."""


@pytest.mark.parametrize(("firmware", "count"), [(tinyphoon, 2), *exhaustive((tinyphoon, 1), (fast, 2))])
def test_built_in_recording(firmware: Firmware, count: int) -> None:
    """The first and the second frame of the soccer scene come out as in numpy, on both cores."""
    with RecordingReader(RECORDING) as reader:
        check_last_frame(list(reader.frames(count)), firmware)


def test_given_recordings(given_recording: Path) -> None:
    """Every frame of the recordings that the command line names, real ones above all."""
    with RecordingReader(given_recording) as reader:
        calibration = calibration_of(reader)
        for frame in reader.frames():
            board, outcome = run([replace(frame, index=0)], tinyphoon.calibrated(calibration))
            for core, picture in (("A", frame.left), ("B", frame.right)):
                sources = calibration.sources.get(core)
                seen = rectified(picture, sources) if sources else picture
                clear = sighted(sources) if sources else None
                check_core(board, core, seen, dict(outcome.frames[0].results), clear)


@pytest.mark.parametrize(
    ("width", "height"),
    [(4, 3), (4, 1), (6, 2), (6, 4), (10, 5), (62, 7), (34, 50), *exhaustive((160, 121), (640, 16))],
)
@BOTH
def test_pictures_of_any_size(firmware: Firmware, width: int, height: int) -> None:
    """Narrow, low and wide pictures, three frames after each other in all three frame buffers."""
    check_last_frame(random_frames(width, height, count=3), firmware)


@BOTH
@pytest.mark.parametrize("name", EXTREMES)
def test_extremes(firmware: Firmware, name: str) -> None:
    """Pictures that no camera takes: as drawn on one core, upside down on the other, after another picture."""
    picture = EXTREMES[name](64, 45)
    check_last_frame(
        [*random_frames(64, 45, count=1), *stereo((picture, picture[::-1].copy()))[:1]], firmware
    )


OVERFLOWS = {
    "an edge in every third column": ("edges_lost",),
    "noise": ("edges_lost", "line_edges_lost"),
    "slopes": ("edges_lost", "edge_groups_shared"),
    "coloured squares": ("blobs_lost", "labels_lost"),
}
"""Pictures with more than there is room for, and what they must say of it."""


@pytest.mark.exhaustive
@pytest.mark.parametrize("name", OVERFLOWS)
def test_overflow_is_counted(name: str) -> None:
    """What has no room is left out as in the references, and counted, on each core for itself."""
    picture = EXTREMES[name](640, 48)
    results = check_last_frame(stereo((picture, np.zeros_like(picture)))).frames[0].results
    for count in OVERFLOWS[name]:
        assert results[f"{count}_A"] > 0
        assert results[f"{count}_B"] == 0


@pytest.mark.parametrize("value", [0, 128, 255])
def test_flat_pictures_have_no_edges(value: int) -> None:
    """A picture of one value has no edge anywhere, not even at its border."""
    flat = np.full((12, 40), value, np.uint8)
    outcome = check_last_frame(stereo((flat, flat)))
    assert set(outcome.frames[0].results.values()) == {0}


@pytest.mark.exhaustive
def test_more_edges_than_have_room_thin_out_in_every_part_of_the_picture() -> None:
    """What is left out is counted, each core for itself, and no band of rows keeps a larger part of its edges than another."""
    noise = np.random.default_rng(5).integers(0, 256, (240, 640), np.uint8)
    noise[120:, 1::2] //= 2  # the lower half has less contrast, and is seen as well
    board, outcome = run(stereo((noise, np.zeros_like(noise))))
    check_edges(board, "A", noise, dict(outcome.frames[0].results), INDOOR_FIELD.edges)
    results = outcome.frames[0].results
    counts = buffer(board, "A", "edge_counts")[0].reshape(8, 30).sum(axis=1)
    assert counts.min() > 0.9 * counts.mean()
    assert 0.9 * EDGE_CAPACITY < results["edges_A"] <= EDGE_CAPACITY
    assert results["edges_lost_A"] > 1000
    assert (results["edges_B"], results["edges_lost_B"]) == (0, 0)


@pytest.mark.exhaustive
def test_noise_leaves_room_for_what_comes_below() -> None:
    """Weak edges that would fill the store: the edge of a bright field below them is seen all the same."""
    noise = np.random.default_rng(1).integers(0, 30, (240, 640), np.uint8)
    noise[200:, 1::2] = 200
    results = check_last_frame(stereo((noise, noise[:, ::-1].copy()))).frames[0].results
    assert results["lines_A"] > 0


@pytest.mark.parametrize(
    ("firmware", "detected"),
    [(tinyphoon, edge_detection), (fast, fast_edge_detection), (thesis, rosenfeld_edges)],
    ids=["plain", "fast", "thesis"],
)
@pytest.mark.parametrize(("width", "height"), [(6, 4), (34, 50), *exhaustive((160, 121))])
def test_larger_gauss(
    firmware: Firmware, detected: Callable[..., Generator[Any, Any, int]], width: int, height: int
) -> None:
    """The edges behind the 5x5 Gauss, which needs two lines more of the picture at a time."""
    thresholds = replace(INDOOR_FIELD.edges, gauss_px=5)

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                yield from detected(core, frame, thresholds, WHOLE_PICTURE)

    frames = random_frames(width, height, count=2)
    board, outcome = run(frames, replace(firmware, mains={"A": main, "B": main}))
    check_edges(board, "A", frames[-1].left, dict(outcome.frames[-1].results), thresholds)
    check_edges(board, "B", frames[-1].right, dict(outcome.frames[-1].results), thresholds)


def test_frames_leave_nothing_behind() -> None:
    """A frame gives the same results after another one as it gives alone."""
    first, second = random_frames(64, 20, count=2)
    _, both = run([first, second])
    _, alone = run([replace(second, index=0)])
    assert both.frames[1].results == alone.frames[0].results


@BOTH
@pytest.mark.parametrize(("width", "height"), [(160, 120), (320, 240), (640, 480)])
def test_everything_fits_in_the_memories_of_the_thesis(firmware: Firmware, width: int, height: int) -> None:
    """Every buffer of all three picture sizes of the robot finds its place, and what asks for L1 is there."""
    placements = board_for(width, height, firmware).link_map.placements
    for_l1 = [each for each in placements if each.symbol.section.startswith("L1_data")]
    assert for_l1
    assert all("L1_DATA" in each.segment for each in for_l1)


def test_lines_too_wide_for_l1_are_a_link_error() -> None:
    """800 pixels do not fit: the linker refuses, it does not spill rings into slow memory."""
    with pytest.raises(LinkError, match="_ring"):
        board_for(800, 600)
