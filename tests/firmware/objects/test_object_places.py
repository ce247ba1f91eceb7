"""Distances in closed form: T Eq. 4.1 to 4.5 in floating point, and how far the integers may be from them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.recording import StereoGeometry
from tests.firmware.objects.object_rig import (
    HEIGHT,
    THESIS,
    WIDTH,
    as_dicts,
    geometries,
    geometry_words,
    object_words,
)
from tinyphoon.geometry import FARTHEST_MM
from tinyphoon.stages.object_places import (
    depth_by_floor,
    depth_by_size,
    depth_of_sphere,
    floor_extent,
    place_object,
    principal,
    see_sphere,
)
from tinyphoon.stores.objects import DIRECTION_Z


@given(geometries, st.integers(1, 4000), st.integers(1, 10_000))
def test_depth_by_size(geometry: StereoGeometry, size_mm: int, extent: int) -> None:
    """T Eq. 4.1 to half a millimetre; the focal length is known to a thirty-second of a pixel."""
    depth = depth_by_size(geometry_words(geometry), size_mm, extent)
    true = 16 * geometry.focal_px * size_mm / extent
    if depth == 0:
        assert true <= 0.51 or true > FARTHEST_MM * (1 - 1 / geometry.focal_px)
    else:
        assert abs(depth - true) <= 0.5 + true / (32 * geometry.focal_px) + 1e-6


@pytest.mark.parametrize("place_mm", [(0, 0, 150), (90, 60, 150), (-200, 150, 400), (300, -200, 1000)])
@pytest.mark.parametrize("radius_mm", [21, 30])
def test_the_image_of_a_sphere(place_mm: tuple[int, int, int], radius_mm: int) -> None:
    """The ellipse that a cone of rays makes gives back the way to the centre, and the depth to half a hundredth.

    That much the middle of the ellipse of a ball 150 mm away is farther out than its centre.
    """
    x, y, z = place_mm
    focal = THESIS.focal_px
    # along x/z, rays at the angles of the axis plus and minus that of the cone; across as on the axis
    off = math.atan(math.hypot(x, y) / z)
    cone = math.asin(radius_mm / math.sqrt(x * x + y * y + z * z))
    inner, outer = (focal * math.tan(off + each) for each in (-cone, cone))
    half_across = focal * radius_mm / math.sqrt(z * z - radius_mm**2)
    mean = round(16 * (half_across + (outer - inner) / 2) / 2)
    along = np.array([x, y]) / max(math.hypot(x, y), 1)
    middle = np.add(np.rint(8 * along * (inner + outer)).astype(int), (principal(WIDTH), principal(HEIGHT)))
    seen = object_words({"image_x": middle[0], "image_y": middle[1]})
    words = geometry_words(THESIS)
    across = see_sphere(words, seen, 0, 2 * mean, WIDTH, HEIGHT)
    (found,) = as_dicts(seen)
    assert across / 32 == pytest.approx(half_across, rel=0.005, abs=0.1)
    assert found["image_x"] == pytest.approx(principal(WIDTH) + 16 * focal * x / z, abs=3)
    assert found["image_y"] == pytest.approx(principal(HEIGHT) + 16 * focal * y / z, abs=3)
    depth = depth_of_sphere(depth_by_size(words, 2 * radius_mm, across), radius_mm)
    assert depth == pytest.approx(z, rel=0.005, abs=1)


@given(geometries, st.integers(0, 600), st.integers(-16 * 240, 16 * 240))
def test_depth_by_floor(geometry: StereoGeometry, floor_mm: int, row: int) -> None:
    """T Eq. 4.4 and 4.5: along the floor, turned into the frame of the camera.

    The row below the horizon is known to 1/16 px, and to what sine and cosine lose of it: 1/4 px in 6000.
    """
    words = geometry_words(geometry)
    tilt = math.radians(geometry.tilt_deg)
    angle = math.atan(row / 16 / geometry.focal_px) + tilt  # T Eq. 4.4
    below = row / 16 * math.cos(tilt) + geometry.focal_px * math.sin(tilt)
    assert abs(floor_extent(words, row) / 16 - below) <= 1 / 16 + (abs(row) / 16 + geometry.focal_px) / 16384
    depth = depth_by_floor(words, row, floor_mm)
    height = geometry.height_mm - floor_mm
    if abs(below) < 2 or abs(height) < 1:
        return
    if height * below < 0:
        assert depth == 0
        return
    along = height / math.tan(angle)  # T Eq. 4.5
    true = along * math.cos(tilt) + height * math.sin(tilt)
    if true < FARTHEST_MM / 2:
        pixels = 1 / 16 + (abs(row) / 16 + geometry.focal_px) / 16384
        off = (
            0.5
            + true * (pixels / (abs(below) - pixels) + 1 / (32 * geometry.focal_px))
            + true / 16 / abs(height)
        )
        assert abs(depth - true) <= off + 1


@pytest.mark.parametrize(
    ("row", "floor_mm", "depth_mm"),
    [
        (0, 0, 691),  # the axis meets the floor: 120 mm / sin 10 degrees
        (-1089, 0, 0),  # on the horizon: f tan 10 degrees above the middle
        (-1200, 0, 0),  # in the sky
        (-1200, 200, 4521),  # in the sky, and above the camera: 80 mm over 6.83 px
        (0, 120, 0),  # as high as the camera: on the horizon alone, and anywhere there
    ],
)
def test_depth_by_floor_at_its_ends(row: int, floor_mm: int, depth_mm: int) -> None:
    """Where the floor is, and where it is not."""
    assert depth_by_floor(geometry_words(), row, floor_mm) == pytest.approx(depth_mm, rel=0.01)


def test_floor_far_away_is_nowhere() -> None:
    """A sixteenth of a pixel below the horizon the floor would be 700 m away."""
    words = geometry_words()
    row = next(row for row in range(-1100, 0) if floor_extent(words, row) == 1)
    assert depth_by_floor(words, row, 0) == 0


def test_size_of_nothing_is_nowhere() -> None:
    """Neither is what has no extent, nor what is too far."""
    assert depth_by_size(geometry_words(), 60, 0) == 0
    assert depth_by_size(geometry_words(), 4000, 1) == 0


@given(st.integers(1, FARTHEST_MM), st.integers(0, 2000))
def test_depth_of_sphere(depth: int, radius: int) -> None:
    """The outline of a sphere at Z is that of a disc at sqrt(Z^2 - r^2)."""
    true = min(math.hypot(depth, radius), FARTHEST_MM)
    assert abs(depth_of_sphere(depth, radius) - true) <= 0.5 + 1e-6


@given(geometries, st.integers(-4000, 9000), st.integers(-4000, 9000), st.integers(1, 4000))
def test_place(geometry: StereoGeometry, x: int, y: int, depth: int) -> None:
    """T Eq. 4.2 and 4.3: on the way through the image, to half a millimetre and the focal length's rounding."""
    table = object_words({"image_x": x, "image_y": y})
    place_object(geometry_words(geometry), table, 0, depth, WIDTH, HEIGHT)
    found = as_dicts(table)[0]
    assert found["z"] == depth
    for name, image, middle in (("x", x, principal(WIDTH)), ("y", y, principal(HEIGHT))):
        true = (image - middle) / 16 / geometry.focal_px * depth
        if abs(true) < FARTHEST_MM:
            assert abs(found[name] - true) <= 0.5 + abs(true) / (32 * geometry.focal_px) + 1e-6


def test_without_depth_it_is_the_direction() -> None:
    """A vector of a known depth, so that nothing has to be divided."""
    table = object_words({"image_x": principal(WIDTH) + 16 * 386, "image_y": principal(HEIGHT)})
    place_object(geometry_words(), table, 0, 0, WIDTH, HEIGHT)
    found = as_dicts(table)[0]
    assert (found["x"], found["y"], found["z"]) == (DIRECTION_Z, 0, DIRECTION_Z)
    assert np.iinfo(np.int16).max > DIRECTION_Z * 4  # 76 degrees aside still fit
