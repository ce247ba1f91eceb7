"""The drawing of what was seen: marks at their places, in their colours, and words that can be read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from bfsim.report.overlay import style
from bfsim.report.overlay.overlay import overlay_of
from bfsim.report.overlay.panel import panel_of, rgb_of
from bfsim.seen import Colour, Seen, SeenEdges, SeenFrame, colours
from tests import seen_frames as made

SCALE = 12  # 960 by 80


def shown(frame: SeenFrame, x_px: float, y_px: float, camera: int = 0) -> Colour:
    """The colour at a place of a picture in the sheet."""
    sheet = overlay_of(frame)
    left = style.MARGIN + camera * (80 * SCALE + style.MARGIN)
    found = sheet.getpixel((round(left + (x_px + 0.5) * SCALE), round(style.HEAD + (y_px + 0.5) * SCALE)))
    assert isinstance(found, tuple)
    return found  # type: ignore[return-value]


def one(**seen: object) -> SeenFrame:
    """A frame with only this in the left picture."""
    nothing = Seen(camera="left", picture=made.grey())
    return made.frame(0, replace(nothing, **seen), Seen(camera="right", picture=made.grey()))  # type: ignore[arg-type]


def test_the_cameras_stand_side_by_side() -> None:
    """Both pictures, magnified by a whole number, a head above and a legend below."""
    sheet = overlay_of(made.frame())
    assert sheet.size == (2 * 80 * SCALE + 3 * style.MARGIN, style.HEAD + 60 * SCALE + style.FOOT)
    assert sheet.getpixel((2, 2)) == style.PAPER
    legend = np.asarray(sheet)[-style.FOOT :]
    for colour in (colours.EDGE, colours.LINE, colours.CIRCLE):
        assert (legend == colour).all(axis=2).any()


def test_a_picture_is_darkened() -> None:
    """Marks stand out of it; grey stays grey."""
    red, green, blue = shown(one(), 40, 30)
    assert red == green == blue < 128 * 0.85


def test_marks_are_where_they_belong() -> None:
    """An edge, the side of a blob, the middle of a line, a circle, in the colours of their kinds."""
    assert shown(one(edges=made.EDGES), 5, 50) == colours.EDGE
    assert shown(one(edges=made.EDGES), 5, 49)[0] == shown(one(), 5, 49)[0]
    assert shown(one(blobs=(made.BLOB,)), 29.5, 35) == made.YELLOW
    assert shown(one(lines=made.LINES), 60, 35) == colours.LINE
    assert shown(one(circles=(made.CIRCLE,)), 39.5 + 9.95, 29.5) == colours.CIRCLE


def test_weak_edges_are_fainter() -> None:
    """The colour says how strong an edge is."""
    frame = one(edges=made.EDGES)
    assert shown(frame, 6, 50)[1] < shown(frame, 5, 50)[1]


def test_what_is_in_space_has_the_colour_of_its_depth() -> None:
    """Lines and edges of the left picture whose depth is known."""
    frame = made.frame()
    assert shown(frame, 15, 5) == colours.depth_colour(400)
    assert shown(frame, 7, 51) == colours.depth_colour(1500)


def test_near_is_red_and_far_is_blue() -> None:
    """The scale does not leave its ends."""
    near, far = colours.depth_colour(-1), colours.depth_colour(1e9)
    assert near == colours.depth_colour(colours.NEAR_MM)
    assert far == colours.depth_colour(colours.FAR_MM)
    assert near[0] == max(near) > near[2]
    assert far[2] == max(far) > far[0]


def test_an_object_is_in_the_picture_that_shows_it() -> None:
    """The goal, which only the right camera has, is marked there."""
    faint = style.faded(made.BLUE, made.GOAL.accuracy)
    assert shown(made.frame(), 20 - 15 - 0.33, 15 + 1, camera=1) == faint
    assert shown(made.frame(), 20 - 15 - 0.33, 15 + 1) != faint


def test_what_is_sure_is_bright() -> None:
    """Accuracy fades the marks of an object, and none out of sight."""
    assert style.faded(made.BLUE, 1) == made.BLUE
    assert made.BLUE > style.faded(made.BLUE, 0.5) > style.faded(made.BLUE, 0) > style.PAPER


def test_captions_say_how_far_and_how_sure() -> None:
    """Distance, accuracy, age; or that there is only a direction."""
    assert made.BALL.caption == "ball  1201 mm  75 %"
    assert made.GOAL.caption == "blue goal  2062 mm  50 %  3 frames ago"
    assert made.MARKER.caption == "robot marker  direction only  20 %"


def test_labels_are_at_their_places() -> None:
    """The label of a 3-D line is in the middle of it, that of an object above it, in pixels of the panel."""
    seen = made.left()
    _, labels = panel_of(seen, (made.BALL,), seen.lines_3d, (), 10)
    depth, ball = labels
    assert (depth.text, depth.x, depth.y) == ("400", 255, 55)
    assert (ball.text, ball.x, ball.y) == (made.BALL.caption, 405, 205)


def test_every_caption_can_be_read() -> None:
    """Objects at one place get labels beside each other: as many boxes as objects."""
    alone = overlay_of(one(objects=(made.BALL,)))
    both = overlay_of(one(objects=(made.BALL, replace(made.BALL, name="other"))))
    colour = style.faded(made.YELLOW, made.BALL.accuracy)
    yellow = [(np.asarray(sheet) == colour).all(axis=2).sum() for sheet in (alone, both)]
    assert yellow[1] > 1.3 * yellow[0]


@pytest.mark.parametrize("size", [(2, 2), (16, 8), (160, 120), (320, 240), (640, 480), (1600, 100)])
def test_pictures_of_any_size_are_drawn(size: tuple[int, int]) -> None:
    """Small ones are magnified, large ones are not reduced."""
    seen = Seen(camera="left", picture=made.grey(*size))
    sheet = overlay_of(made.frame(0, seen, replace(seen, camera="right")))
    assert sheet.width >= 2 * size[0]


def test_one_camera_alone_is_drawn_too() -> None:
    """A board with one camera."""
    sheet = overlay_of(made.frame(0, made.left()))
    assert sheet.width < 2 * sheet.height


def test_an_edge_at_every_pixel_is_drawn() -> None:
    """The corners of the picture belong to it."""
    y, x = (each.ravel().astype(np.int32) for each in np.mgrid[0:60, 0:80])
    full = np.full(len(x), 255, np.int32)
    frame = one(edges=SeenEdges(x_px=x, y_px=y, gradients=full, directions=full))
    assert {shown(frame, *corner) for corner in ((0, 0), (79, 0), (0, 59), (79, 59))} == {colours.EDGE}


def test_colours_of_the_camera_are_kept() -> None:
    """UYVY in full range, as recordings have it: pure red within rounding."""
    red = Image.new("RGB", (4, 2), (255, 0, 0)).convert("YCbCr")
    y, cb, cr = red.getpixel((0, 0))  # type: ignore[misc]
    uyvy = np.tile(np.array([cb, y, cr, y], np.uint8), (2, 2))
    found = np.asarray(rgb_of(uyvy)).reshape(-1, 3).astype(int)
    assert np.abs(found - (255, 0, 0)).max() <= 2
