"""What a camera sees of any records of a picture: bit for bit what the reference does."""

from __future__ import annotations

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from bfsim.recording import StereoGeometry
from tests.firmware.objects.object_rig import HEIGHT, THESIS, THRESHOLDS, WIDTH
from tests.firmware.objects.sight_rig import MOUTH, ROUND, SEEN_WELL, see
from tinyphoon.strategy.models import BLUE, RED, YELLOW


@st.composite
def boxes(draw: st.DrawFn) -> dict[str, int]:
    """Any blob of a picture; balls and goals among them."""
    if draw(st.booleans()):
        nudge = {name: draw(st.integers(-6, 6)) for name in ("left", "right", "top", "bottom")}
        box = {**draw(st.sampled_from([ROUND, MOUTH]))}
        return {name: value + nudge.get(name, 0) for name, value in box.items()}
    left, right = sorted(draw(st.tuples(*[st.integers(1, WIDTH - 2)] * 2)))
    top, bottom = sorted(draw(st.tuples(*[st.integers(1, HEIGHT - 2)] * 2)))
    most = (right - left + 1) * (bottom - top + 1)
    pixels = draw(st.integers(1, most) | st.just(max(most * 201 // 256, 1)))
    colours = draw(st.sampled_from([BLUE, YELLOW, RED, 2]))
    return {"colours": colours, "pixels": pixels, "left": left, "right": right, "top": top, "bottom": bottom}


circles = st.fixed_dictionaries(
    {
        "x": st.integers(0, 16 * WIDTH),
        "y": st.integers(0, 16 * HEIGHT),
        "radius": st.integers(0, 4000),
        "blob": st.integers(0, 4),
        "tests": st.sampled_from([0, 1, 3, 3]),
        "arc": st.sampled_from([0, 84, 85, 256]),
    }
) | st.builds(
    lambda blob, nudge: SEEN_WELL | {"blob": blob, "x": 2552 + nudge}, st.integers(0, 4), st.integers(-99, 99)
)
borders = st.fixed_dictionaries(
    {"left": st.sampled_from([-1, 1]), "right": st.sampled_from([-1, 1]), "top": st.just(-1)}
    | {"bottom": st.integers(-1, 0), "blob": st.integers(0, 4), "hidden": st.integers(0, 3)}
    | {f"{side}_rows": st.tuples(st.integers(0, 120), st.integers(0, 239)) for side in ("left", "right")}
    | {f"{side}_foot": st.integers(0, 16 * HEIGHT) for side in ("left", "right")}
)
level_lines = st.tuples(
    st.integers(0, 2000), st.integers(0, 3800), st.integers(2500, 5000), st.integers(0, 3800)
)
upright_lines = st.tuples(
    st.integers(0, 5000), st.integers(0, 1900), st.integers(0, 5000), st.integers(1900, 3800)
)


@given(
    st.lists(boxes(), max_size=6).flatmap(
        lambda some: st.tuples(
            st.just(some), st.tuples(*[st.integers(at, max(len(some) - 1, 0)) for at in range(len(some))])
        )
    ),
    st.lists(circles, max_size=4),
    st.lists(borders, max_size=4),
    st.tuples(level_lines, upright_lines),
    st.fixed_dictionaries({"refined": st.booleans(), "circle_area": st.booleans()}),
    st.sampled_from([THESIS, StereoGeometry(311, 30, 60, 0), StereoGeometry(772, 60, 300, 45)]),
)
def test_as_the_reference(blobs, circles, rectangles, lines, ways, geometry) -> None:
    """Bit for bit, with any records."""
    thresholds = replace(THRESHOLDS, **ways)
    boxes, parents = blobs
    limits = {"thresholds": thresholds, "geometry": geometry, "room": 4}
    see(boxes, circles, rectangles, parents=parents, lines=lines, **limits)
