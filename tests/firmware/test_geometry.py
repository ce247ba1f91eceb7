"""The geometry of the cameras on its way from a recording to the kernels, and depth by T Eq. 3.16 and 3.17."""

from __future__ import annotations

from fractions import Fraction
from math import floor
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.api import Calibration, FirmwareError, FrameSize
from bfsim.recording import RecordingReader, StereoGeometry
from bfsim.recording.writer import RecordingWriter
from bfsim.running.assumptions import assumed_geometry, geometry_in_words
from bfsim.running.inputs import calibration_of
from tests.firmware.whole_pictures import buffer, random_frames, run
from tinyphoon import fast, one_eye, tinyphoon
from tinyphoon.geometry import FARTHEST_MM, GEOMETRY_WORDS, beside_mm, depth_mm, geometry_buffer, look_at
from tinyphoon.stages.object_places import depth_by_floor
from tinyphoon.stores.lines import SUBPIXELS

THESIS = [386 * 16, 30470, 120 * 16, 1820, 2845, 16135, 0, 0, 386 * 16]
"""T §6.2, §6.4, in the units of the buffer; 10 degrees are 1820.4 steps, with a sine of 2845.0 / 16384."""


def words(focal: int, baseline: int) -> np.ndarray:
    """A geometry buffer, in its own units."""
    return np.array([focal, baseline, *[0] * (GEOMETRY_WORDS - 2)], np.int32)


@pytest.mark.parametrize("firmware", [tinyphoon, one_eye])
def test_a_recording_brings_its_geometry(tmp_path: Path, firmware) -> None:
    """From the file into the one buffer of that name of each core."""
    geometry = StereoGeometry(focal_px=311.25, baseline_mm=30.001, height_mm=60.5, tilt_deg=-22.5)
    (frame,) = random_frames(16, 8, count=1)
    with RecordingWriter(tmp_path / "a.mcap", width=16, height=8, geometry=geometry) as writer:
        writer.add(frame.left, frame.right, left_ns=1, right_ns=2)
    with RecordingReader(tmp_path / "a.mcap") as reader:
        program = firmware.calibrated(calibration_of(reader))
    for core in firmware.mains:
        (found,) = (each for each in program.buffers(FrameSize(16, 8))[core] if each.name == "geometry")
        assert list(found.values) == [4980, 30001, 968, -4096, -6270, 15137, 0, 0, 4980]


@pytest.mark.parametrize("calibration", [None, Calibration()])
def test_without_geometry_it_is_that_of_the_thesis(calibration: Calibration | None) -> None:
    """Also in the memory of a board, where kernels find it."""
    program = tinyphoon.calibrated(calibration) if calibration else tinyphoon
    board, _ = run(random_frames(320, 16, count=1), program)
    assert [buffer(board, core, "geometry")[0].tolist() for core in "AB"] == [THESIS, THESIS]


def test_larger_pictures_of_the_same_camera_have_more_pixels_to_its_focal_length() -> None:
    """The thesis measured it at 320x240."""
    for each in tinyphoon.buffers(FrameSize(640, 480))["A"]:
        if each.name == "geometry":
            assert list(each.values) == [2 * THESIS[0], *THESIS[1:8], 2 * THESIS[8]]


def test_what_nobody_measured_is_that_of_the_thesis_and_a_single_camera_has_no_baseline() -> None:
    """After a calibration of one camera only its focal length is known."""
    found = geometry_buffer(StereoGeometry(311.25, 0))
    assert found.values is not None
    assert list(found.values) == [4980, 0, *THESIS[2:8], 4980]


@pytest.mark.parametrize(
    ("geometry", "in_words", "warning"),
    [
        (
            StereoGeometry(400, 60, 120, 10),
            "focal length 400 px, baseline 60 mm, height 120 mm, looking down 10°",
            None,
        ),
        (
            StereoGeometry(400, 0, 120),
            "focal length 400 px, a single camera, height 120 mm, tilt unknown",
            "the tilt of",
        ),
        (
            StereoGeometry(400, 60),
            "height unknown, tilt unknown (of the recording)",
            "the height and tilt of",
        ),
        (None, "assumed: that of the thesis's robot", "does not say where its cameras are"),
    ],
)
def test_a_run_says_its_geometry_and_what_it_assumed(
    geometry: StereoGeometry | None, in_words: str, warning: str | None
) -> None:
    """Depths and places depend on it."""
    calibration = Calibration(geometries=(geometry,) if geometry else ())
    assert in_words in geometry_in_words(tinyphoon, calibration)
    texts = [each.text for each in assumed_geometry(tinyphoon, calibration)]
    assert len(texts) == (warning is not None)
    assert (warning or "") in "".join(texts)


def test_cameras_that_32_bits_cannot_compute_with_are_refused() -> None:
    """Focal length times baseline is the largest number of all."""
    geometry_buffer(StereoGeometry(1000.0, 134.0, 0, 0))
    with pytest.raises(
        FirmwareError, match="must be below 134218 px mm, not 1000 px times 135 mm; give .* in cm"
    ):
        geometry_buffer(StereoGeometry(1000.0, 135.0, 0, 0))


@pytest.mark.parametrize(
    ("geometry", "what"),
    [
        ((0.99, 30.0, 120.0), "focal length of the cameras must be at least 1 px, not 0.99 px"),
        (
            (386.0, 0.0009, 120.0),
            "baseline of the cameras must be at least 0.001 mm, or 0 for a single one, not 0.0009 mm",
        ),
        ((386.0, 30.0, 1e9), r"length times height .* below 8388608 px mm, not 386 px times 1e\+09 mm"),
        ((386.0, 30.0, -21800.0), "length times height .* below 8388608 px mm, not 386 px times 21800 mm"),
    ],
)
def test_cameras_that_are_nowhere_are_refused(geometry: tuple[float, float, float], what: str) -> None:
    """In words about the cameras, before any kernel divides by 0 or leaves 32 bits."""
    with pytest.raises(FirmwareError, match=what):
        geometry_buffer(StereoGeometry(*geometry, tilt_deg=0.0))


@pytest.mark.parametrize(("focal_px", "height_mm"), [(1.0, 1e6), (386.0, 21700.0), (386.0, -21700.0)])
def test_the_highest_camera_sees_the_floor_where_it_is(focal_px: float, height_mm: float) -> None:
    """A point so far from the principal point that it is one height away: no product has left 32 bits."""
    values = np.array(geometry_buffer(StereoGeometry(focal_px, 1.0, height_mm, 0.0)).values, np.int32)
    row = round(SUBPIXELS * focal_px) * (1 if height_mm > 0 else -1)
    depth = abs(height_mm) if abs(height_mm) <= FARTHEST_MM else 0
    assert depth_by_floor(values, row, 0) == depth


def test_pictures_too_large_for_the_geometry_of_the_thesis_must_bring_theirs() -> None:
    """The message says how. With a geometry of its own, no picture is too large but for the memory."""
    tinyphoon.calibrated(Calibration(size=FrameSize(3648, 16)))
    for firmware in (tinyphoon, one_eye, fast):
        with pytest.raises(
            FirmwareError, match=r"at most 3651 px wide, not of 4096x16: .* --resize.* `--geometry`"
        ):
            firmware.calibrated(Calibration(size=FrameSize(4096, 16)))
    own = Calibration(size=FrameSize(4096, 16), geometries=(StereoGeometry(386.0, 30.0, 120.0, 10.0),))
    (found,) = (
        each
        for each in tinyphoon.calibrated(own).buffers(FrameSize(4096, 16))["A"]
        if each.name == "geometry"
    )
    assert list(found.values)[:2] == [386 * 16, 30000]


@given(st.integers(1, 1 << 15), st.integers(1, 65535), st.integers(-100, 1 << 15))
def test_depth_is_equation_3_16(focal: int, baseline: int, disparity: int) -> None:
    """Z = f T / d, rounded; 0 for what is nowhere or does not fit into 16 bits."""
    expected = floor(Fraction(focal * baseline, 1000 * disparity) + Fraction(1, 2)) if disparity > 0 else 0
    assert depth_mm(words(focal, baseline), disparity) == (expected if expected <= FARTHEST_MM else 0)


@given(st.integers(16, 1 << 15), st.integers(1, FARTHEST_MM), st.integers(-(1 << 14), 1 << 14))
def test_beside_is_equation_3_17(focal: int, depth: int, off_axis: int) -> None:
    """X = Z x / f, rounded, over the whole of a picture of 2048 pixels."""
    assert beside_mm(words(focal, 1), depth, off_axis) == floor(
        Fraction(depth * off_axis, focal) + Fraction(1, 2)
    )


def test_a_mode_changes_what_depends_on_it() -> None:
    """The focal length in halved pictures, from the recorded one each time; where the principal point is."""
    geometry = np.array(THESIS, np.int32)
    look_at(geometry, -40, 7, 2)
    assert geometry.tolist() == [386 * 4, *THESIS[1:6], -40, 7, 386 * 16]
    look_at(geometry, 0, 0, 0)
    assert geometry.tolist() == THESIS
