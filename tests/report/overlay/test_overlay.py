"""The drawing of what was seen: marks at their places, in their colours, and words that can be read."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from bfsim.report.overlay import style
from bfsim.report.overlay.above import LEAST_HEIGHT
from bfsim.report.overlay.ground import MAP_SHARE, picture_with_edges
from bfsim.report.overlay.heat import BARS, GAP, LINE, STAGES, _time
from bfsim.report.overlay.layers import LAYERS
from bfsim.report.overlay.overlay import overlay_of
from bfsim.report.overlay.panel import panel_of
from bfsim.seen import (
    Colour,
    Seen,
    SeenArrow,
    SeenEdges,
    SeenEdges3D,
    SeenFrame,
    SeenHeat,
    SeenLoss,
    SeenMap,
    SeenText,
    colours,
)
from bfsim.seen.heat import COLOURS, SHARE, heated
from bfsim.seen.in_space import no_edges_3d
from bfsim.seen.pictures import rgb_of
from tests import seen_frames as made

SCALE = 12  # 960 by 80
SCALE_OF_FRAME = colours.depths_of(made.frame())


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
    above = 60 * SCALE * 3 // 4 + style.MARGIN
    assert sheet.size == (2 * 80 * SCALE + 3 * style.MARGIN + above, style.HEAD + 60 * SCALE + style.FOOT)
    assert sheet.getpixel((2, 2)) == style.PAPER
    legend = np.asarray(sheet)[-style.FOOT :]
    for colour in (colours.EDGE, colours.LINE, colours.CIRCLE):
        assert (legend == colour).all(axis=2).any()


@pytest.mark.parametrize("wanted_px", [400, 640, 960])
def test_words_above_a_picture_never_overprint(wanted_px: int) -> None:
    """Of a cluttered picture that is drawn small some numbers are left out: when it was taken stands free."""
    every = np.indices((60, 80)).reshape(2, -1).astype(np.int32)
    full = SeenEdges(x_px=every[1], y_px=every[0], gradients=every[0], directions=every[0], lost=123_456)
    seen = made.left(edges=full, blobs=made.left().blobs * 100, lines=made.left().lines * 1000)
    frame = made.frame(0, seen, replace(seen, camera="right"))
    head = np.asarray(overlay_of(frame, LAYERS, wanted_px))[: style.HEAD]
    font, when = style.font(style.FONT), f"frame 0   {frame.times_ns['left'] / 1e9:.3f} s"
    end = round(2 * style.MARGIN + font.getlength("left camera") + font.getlength(when))
    assert (head[:, end - 12 : end] != style.PAPER).any()
    assert (head[:, end + 2 : end + style.MARGIN - 2] == style.PAPER).all()


def test_pictures_of_a_line_have_a_view_from_above_beside_them() -> None:
    """It was as high as they are, and had no pixels where that was one: a page of it ended in a traceback."""
    flat = {"picture": made.grey(640, 1), "geometry": made.GEOMETRY}
    sheet = overlay_of(made.frame(0, *(Seen(camera=each, **flat) for each in ("left", "right"))))  # type: ignore[arg-type]
    assert sheet.height == style.HEAD + LEAST_HEIGHT + style.FOOT


def test_the_legend_is_of_what_is_drawn() -> None:
    """A layer that is left out is not explained; the sheet is as large."""
    whole, lines = overlay_of(made.frame()), overlay_of(made.frame(), ("lines", "above"))
    assert whole.size == lines.size
    legend = np.asarray(lines)[-style.FOOT :]
    shown_there = [
        (legend == each).all(axis=2).any() for each in (colours.EDGE, colours.LINE, colours.CIRCLE)
    ]
    assert shown_there == [False, True, False]


def test_a_legend_that_is_wider_than_the_pictures_has_rows() -> None:
    """As those of a page: the sheet was as wide as the legend, with nothing beside the pictures, also where it was empty."""
    marked, bare = (overlay_of(each, LAYERS, 480) for each in (one(lines=made.LINES), one()))
    assert marked.size == bare.size == (2 * 480 + 3 * style.MARGIN, style.HEAD + 360 + 2 * style.FOOT)
    first, second = np.asarray(marked)[-2 * style.FOOT :].reshape(2, style.FOOT, -1, 3)
    assert (first == colours.CIRCLE).all(axis=2).any()
    assert not (second == colours.CIRCLE).all(axis=2).any()
    assert (second != style.PAPER).any()


def test_without_marks_there_is_nothing_to_explain() -> None:
    """Firmware without a view has none; the sheet is as large."""
    bare = overlay_of(one())
    assert bare.size == overlay_of(one(lines=made.LINES)).size
    assert (np.asarray(bare)[-style.FOOT :] == style.PAPER).all()


@pytest.mark.parametrize("us", [0.5, 44.1, 99.9, 100, 12345])
def test_times_have_no_sign_that_the_font_lacks(us: float) -> None:
    """What it lacks is drawn as the same empty box as any other sign that it lacks."""
    font = style.font(style.FONT)
    lacking = bytes(font.getmask("\u2603"))
    assert not any(bytes(font.getmask(sign)) == lacking for sign in _time(us) if sign != " ")
    assert bytes(font.getmask("\u00b5")) == lacking


def test_a_picture_is_darkened() -> None:
    """Marks stand out of it; grey stays grey."""
    red, green, blue = shown(one(), 40, 30)
    assert red == green == blue < 128 * 0.92


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
    assert shown(frame, 15, 5) == SCALE_OF_FRAME.colour(400)
    assert shown(frame, 7, 51) == SCALE_OF_FRAME.colour(1500)


def test_near_is_red_and_far_is_blue() -> None:
    """The scale does not leave its ends."""
    near, far = colours.ROOM.colour(-1), colours.ROOM.colour(1e9)
    assert near == colours.ROOM.colour(colours.ROOM.near_mm)
    assert far == colours.ROOM.colour(colours.ROOM.far_mm)
    assert near[0] == max(near) > near[2]
    assert far[2] == max(far) > far[0]


def test_the_scale_is_of_the_depths_that_occur() -> None:
    """From round numbers around them; that of a room where no depth is known."""
    assert (SCALE_OF_FRAME.near_mm, SCALE_OF_FRAME.far_mm) == (300, 2000)
    assert colours.depths_of(one()) == colours.ROOM
    far = SeenEdges3D(
        places_mm=np.array([[0, 0, 7100]] * 30 + [[0, 0, 99]], np.int32), left_edges=np.zeros(31, np.int32)
    )
    scale = colours.depths_of(one(edges_3d=far))
    assert (scale.near_mm, scale.far_mm) == (7100, 7500)


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
    _, labels = panel_of(seen, (made.BALL,), seen.lines_3d, (), 10, colours.ROOM)
    depth, ball = labels
    assert (depth.text, depth.x, depth.y) == ("400", 255, 55)
    assert (ball.text, ball.x, ball.y) == (made.BALL.caption, 405, 305)
    assert ball.named == (305, 205, 505, 405)


@pytest.mark.parametrize(
    "layer", [each for each in LAYERS if each not in {"arrows", "texts", "map", "losses"}]
)
def test_a_layer_is_drawn_alone_or_left_out(layer: str) -> None:
    """Each changes the sheet of a frame with everything."""
    frame = made.frame()
    bare = overlay_of(frame, ())
    assert not np.array_equal(overlay_of(frame, (layer,)).resize(bare.size), bare)


def test_where_something_had_no_room_is_marked() -> None:
    """A bar beside the rows, half as long where half as much is missing, and words beside the worst."""
    losses = (
        SeenLoss(what="edges", top_px=0, bottom_px=29, share=1.0),
        SeenLoss(what="edges", top_px=30, bottom_px=59, share=0.5),
    )
    frame = one(losses=losses)
    assert [shown(frame, x, 2) == colours.LOSS for x in (0, 1.7, 2.5)] == [True, True, False]
    assert [shown(frame, x, 40) == colours.LOSS for x in (0, 0.5, 1.7)] == [True, True, False]
    _, labels = panel_of(frame.cameras[0], (), (), (), 1, colours.ROOM)
    assert [each.text for each in labels] == ["no room for 100 % of the edges here"]


def test_what_others_want_to_draw_is_drawn() -> None:
    """An arrow, words, and a map: red for its greatest number, blue for its least, nothing for none."""
    arrow = SeenArrow(start_px=(10, 10), end_px=(50, 10), colour=made.YELLOW, text="fast")
    assert shown(one(arrows=(arrow,)), 30, 10) == shown(one(arrows=(arrow,)), 49, 10) == made.YELLOW
    _, labels = panel_of(one(arrows=(arrow,)).cameras[0], (), (), (), 1, colours.ROOM)
    assert [each.text for each in labels] == ["fast"]
    words = one(texts=(SeenText(place_px=(40, 30), text="HELLO", colour=made.BLUE),))
    assert (np.asarray(overlay_of(words)) == made.BLUE).all(axis=2).sum() > 50
    heat = one(map=SeenMap(name="heat", values=np.array([[0.0, 1.0], [np.nan, 3.0]])))
    low, high = shown(heat, 20, 15), shown(heat, 60, 45)
    assert low[2] > low[0]
    assert high[0] > high[2]
    assert shown(heat, 20, 45) == shown(one(), 20, 45)


def test_a_map_may_have_a_number_for_each_pixel(monkeypatch: pytest.MonkeyPatch) -> None:
    """As one of depths has: each number was painted by itself, which took a second and more a picture. The colours are the same."""
    asked = []
    scale_colour = colours.scale_colour
    monkeypatch.setattr(colours, "scale_colour", lambda part: asked.append(part) or scale_colour(part))
    values = np.linspace(0, 1, 240 * 320).reshape(240, 320)
    plain = Seen(camera="left", picture=made.grey(320, 240))
    seen = replace(plain, map=SeenMap(name="depth", values=values))
    under, over = (picture_with_edges(each, (), 1, colours.ROOM, 0).astype(float) for each in (plain, seen))
    assert len(asked) < 10_000
    for place in ((0, 0), (100, 17), (120, 200), (239, 319)):
        expected = (1 - MAP_SHARE) * under[place] + MAP_SHARE * np.array(scale_colour(1 - values[place]))
        assert np.abs(over[place] - expected).max() < 3


@pytest.mark.parametrize(
    "size", [(2, 2), (16, 8), (160, 120), (320, 240), (640, 480), (1600, 100), (2, 480), (34, 4000)]
)
def test_pictures_of_any_size_are_drawn(size: tuple[int, int]) -> None:
    """Small ones are magnified, large ones are not reduced, and slim ones do not become towers: 2 by 480 took more than a minute."""
    seen = Seen(camera="left", picture=made.grey(*size))
    sheet = overlay_of(made.frame(0, seen, replace(seen, camera="right")))
    assert sheet.width >= 2 * size[0]
    assert sheet.height <= max(2 * style.PANEL_WIDTH, size[1]) + style.HEAD + style.FOOT


@pytest.mark.parametrize("far_mm", [150, 2_500_000, 2_600_000, 1e8])
def test_places_of_any_distance_are_drawn(far_mm: float) -> None:
    """As of objects with next to no disparity: those of more than 2.5 km ended in a traceback."""
    ball = replace(made.BALL, place_mm=(0, 0, far_mm))
    left = made.left(objects=(ball,), lines_3d=(), edges_3d=no_edges_3d())
    sheet = overlay_of(made.frame(0, left, Seen(camera="right", picture=made.grey())))
    assert sheet.width > sheet.height


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


def hot(us: float) -> SeenHeat:
    """Heat of two stages in row 30: the first one costs a pixel `us`, the second one half of that in its left half."""
    first, second = np.zeros((2, 60, 80))
    first[30], second[30, :40] = us, us / 2
    return SeenHeat(stages_us={"Edges": first, "Blobs": second}, elsewhere_us={"Edges": 1.0, "Blobs": 0.0})


def test_heat_lies_over_the_picture_by_what_a_place_cost() -> None:
    """The dearest place of both pictures has the end of the scale, two thirds of it two thirds, no time its beginning."""
    right = Seen(camera="right", picture=made.grey(), heat=hot(2))
    frame = made.frame(0, Seen(camera="left", picture=made.grey(), heat=hot(4)), right)
    grey = np.array(shown(one(), 40, 10))
    for x, y, level in ((10, 30, 255), (70, 30, 170), (10, 10, 0)):
        assert np.abs(grey + SHARE * (COLOURS[level] - grey) - shown(frame, x, y)).max() <= 1
    sheet, width = np.asarray(overlay_of(frame)), 80 * SCALE
    after = style.MARGIN + width + GAP + BARS + style.MARGIN
    assert tuple(sheet[style.HEAD + 30 * SCALE, after + 10]) != tuple(
        sheet[style.HEAD + 10 * SCALE, after + 10]
    )


def test_work_without_a_place_heats_nothing() -> None:
    """A firmware that takes its lines by a DMA of its own has none: `--mcap` with `--heat` ended in a traceback."""
    picture = rgb_of(made.grey())
    assert np.array_equal(heated(picture, hot(0), 0.0), picture)
    cold = made.frame(0, *(Seen(camera=each, picture=made.grey(), heat=hot(0)) for each in ("left", "right")))
    assert overlay_of(cold).height > overlay_of(one()).height, "the legend says what it cost elsewhere"


def test_bars_say_what_each_row_cost_by_stage() -> None:
    """The dearest row of both pictures is the longest bar: four fifths of it the first stage's here; other rows have none."""
    frame = made.frame(
        0, *(Seen(camera=each, picture=made.grey(), heat=hot(4)) for each in ("left", "right"))
    )
    sheet = np.asarray(overlay_of(frame))
    left = style.MARGIN + 80 * SCALE + GAP
    bar = sheet[style.HEAD + 30 * SCALE + 1, left : left + BARS]
    assert [(bar == colour).all(axis=1).sum() for colour in STAGES[:2]] == [BARS * 4 // 5, BARS // 5]
    assert (sheet[style.HEAD + 10 * SCALE, left : left + BARS] == style.GRID).all()
    assert sheet.shape[0] >= style.HEAD + 60 * SCALE + style.FOOT + 2 * LINE
    assert (sheet[-style.MARGIN // 2 :] == style.PAPER).all(), "the last words stood at the edge"


def test_colours_of_heat_become_lighter_evenly() -> None:
    """So that what looks twice as light is twice as dear: by the luminance of sRGB, never darker on the way up."""
    linear = (COLOURS / 255.0) ** 2.2 @ np.array([0.2126, 0.7152, 0.0722])
    assert (np.diff(linear) >= -0.002).all()
    assert linear[0] < 0.02
    assert linear[-1] > 0.7
