"""Cameras after new settings: off for some frames, less in each, then exactly as recorded."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from bfsim.chip.sensor_spec import CameraSpec
from bfsim.chip.sensors import LEFT_CAMERA, RIGHT_CAMERA
from bfsim.machine.cameras.settling import CameraSettings, Settling, settled

SETTINGS = CameraSettings(exposure_lines=200, gain=16, red_gain=128, blue_gain=128)
each_camera = pytest.mark.parametrize("camera", [LEFT_CAMERA, RIGHT_CAMERA], ids=lambda each: each.name)
PICTURES = arrays(np.uint8, (3, 16))


def plain(picture: np.ndarray, frames: int, camera: CameraSpec) -> np.ndarray:
    """Do the same byte by byte, in Python's integers."""
    left = max(0, camera.settling_frames - frames)
    sent = []
    for position, octet in enumerate(picture.ravel().tolist()):
        if position % 2:
            off = octet * left * camera.y_step_256ths // 256
        else:
            off = left * (camera.v_step_levels if position % 4 else camera.u_step_levels)
        sent.append(min(max(octet + off, 0), 255))
    return np.array(sent, np.uint8).reshape(picture.shape)


def uniform(level: int) -> np.ndarray:
    """Return a picture of 8x4 pixels, all bytes the same."""
    return np.full((4, 16), level, np.uint8)


@each_camera
@given(picture=PICTURES, frames=st.integers(0, 12))
def test_every_byte_is_as_in_plain_integers(camera: CameraSpec, picture: np.ndarray, frames: int) -> None:
    """Nothing wraps, in 8 bits or in 16, and each byte gets what its place in UYVY says."""
    before = picture.copy()
    sent = settled(picture, frames, camera)
    assert np.array_equal(sent, plain(picture, frames, camera))
    assert np.array_equal(settled(picture, frames, camera), sent)
    assert np.array_equal(picture, before)


@each_camera
def test_identity_from_the_last_frame_on_and_not_before(camera: CameraSpec) -> None:
    """The gate from both sides: the frame before it is still off."""
    picture = uniform(100)
    assert not np.array_equal(settled(picture, camera.settling_frames - 1, camera), picture)
    for frames in (0, 1, 1000):
        assert settled(picture, camera.settling_frames + frames, camera) is picture


@each_camera
@given(picture=PICTURES)
def test_the_error_only_decays(camera: CameraSpec, picture: np.ndarray) -> None:
    """Each frame is at least as near to the recorded picture as the one before, on average and in every byte."""
    errors = [
        np.abs(settled(picture, frames, camera).astype(int) - picture)
        for frames in range(camera.settling_frames + 1)
    ]
    for earlier, later in pairwise(errors):
        assert (later <= earlier).all()
    assert not errors[-1].any()


@each_camera
def test_first_picture_is_bright_and_drifts_towards_yellow(camera: CameraSpec) -> None:
    """As in T Figure 6.8: yellow is low U and somewhat high V."""
    grey = np.tile(np.array([128, 100, 128, 100], np.uint8), (4, 4))
    first = settled(grey, 0, camera)
    assert (first[:, 1::2] > 120).all()
    assert (first[:, 0::4] < 110).all()
    assert (first[:, 2::4] > 128).all()


@each_camera
def test_black_and_white_stay_within_bytes(camera: CameraSpec) -> None:
    """Y of black has no gain to show, Y of white no room; colours stop at 0 and 255."""
    black, white = settled(uniform(0), 0, camera), settled(uniform(255), 0, camera)
    assert not black[:, 1::2].any()
    assert not black[:, 0::4].any()
    assert (white[:, 1::2] == 255).all()
    assert (white[:, 2::4] == 255).all()


def test_the_two_cameras_are_off_differently() -> None:
    """A stereo pair does not only change: it disagrees."""
    picture = uniform(100)
    assert not np.array_equal(settled(picture, 0, LEFT_CAMERA), settled(picture, 0, RIGHT_CAMERA))


@pytest.mark.parametrize("size", [(120, 320), (240, 640), (480, 1280)])
def test_shape_and_kind_are_kept_of_pictures_that_cannot_be_written(size: tuple[int, int]) -> None:
    """Pictures of recordings may be read-only."""
    picture = np.full(size, 90, np.uint8)
    picture.flags.writeable = False
    sent = settled(picture, 0, LEFT_CAMERA)
    assert (sent.shape, sent.dtype) == (size, np.uint8)


def test_a_change_of_settings_starts_it_again() -> None:
    """A fresh camera settles, stays so when the same settings are written, and starts again with new ones."""
    camera, picture = LEFT_CAMERA, uniform(100)
    settling = Settling(camera, SETTINGS)
    fresh = [settling.next_picture(picture) for _ in range(camera.settling_frames)]
    assert np.array_equal(fresh[0], settled(picture, 0, camera))
    assert settling.next_picture(picture) is picture
    settling.change(replace(SETTINGS))
    assert settling.next_picture(picture) is picture
    settling.change(replace(SETTINGS, gain=17))
    assert settling.settings.gain == 17
    again = [settling.next_picture(picture) for _ in range(camera.settling_frames)]
    assert all(np.array_equal(*pair) for pair in zip(again, fresh, strict=True))
    assert settling.next_picture(picture) is picture
