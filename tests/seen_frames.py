"""What was seen, made by hand, for the tests of everything that shows it."""

from __future__ import annotations

import numpy as np

from bfsim.seen import (
    Seen,
    SeenBlob,
    SeenCircle,
    SeenEdges,
    SeenEdges3D,
    SeenFrame,
    SeenGeometry,
    SeenLine,
    SeenLine3D,
    SeenObject,
    Solid,
)

YELLOW = (255, 219, 51)
BLUE = (51, 165, 255)

BALL = SeenObject(
    name="ball",
    solid=Solid.SPHERE,
    colour=YELLOW,
    width_mm=60,
    height_mm=60,
    accuracy=0.75,
    tests=("colour", "size"),
    place_mm=(30.0, 40.0, 1200.0),
    is_direction=False,
    camera="left",
    image_px=(40.0, 30.0),
    image_size_px=(20.0, 20.0),
    age_frames=0,
)
GOAL = SeenObject(
    name="blue goal",
    solid=Solid.BOX,
    colour=BLUE,
    width_mm=400,
    height_mm=100,
    accuracy=0.5,
    tests=("colour",),
    place_mm=(-500.0, 0.0, 2000.0),
    is_direction=False,
    camera="right",
    image_px=(20.0, 20.0),
    image_size_px=(30.0, 10.0),
    age_frames=3,
)
MARKER = SeenObject(
    name="robot marker",
    solid=Solid.BOX,
    colour=(255, 54, 51),
    width_mm=75,
    height_mm=50,
    accuracy=0.2,
    tests=(),
    place_mm=(0.0, 300.0, 400.0),
    is_direction=True,
    camera="left",
    image_px=(60.0, 10.0),
    image_size_px=(6.0, 4.0),
    age_frames=0,
)

EDGES = SeenEdges(
    x_px=np.array([5, 6, 7], np.int32),
    y_px=np.array([50, 50, 51], np.int32),
    gradients=np.array([255, 40, 96], np.int32),
    directions=np.array([0, 64, 128], np.int32),
)
LINES = (
    SeenLine(start_px=(60.0, 20.0), end_px=(60.0, 50.0), edges=30, probability=1.0),
    SeenLine(start_px=(10.0, 5.0), end_px=(40.0, 5.0), edges=15, probability=0.5),
)
BLOB = SeenBlob(
    left_px=30,
    top_px=20,
    right_px=49,
    bottom_px=39,
    centre_px=(39.5, 29.5),
    pixels=314,
    colours=0x07000000,
    colour=YELLOW,
)
CIRCLE = SeenCircle(centre_px=(39.5, 29.5), radius_px=10.0, edges=60, passed=True, tests=("centre", "radius"))


GEOMETRY = SeenGeometry(
    focal_px=386.0, principal_px=(39.5, 29.5), baseline_mm=30.47, height_mm=120.0, tilt_deg=10.0
)


def grey(width_px: int = 80, height_px: int = 60) -> np.ndarray:
    """A grey UYVY picture."""
    return np.full((height_px, 2 * width_px), 128, np.uint8)


def left(**changes: object) -> Seen:
    """What the core with the results of both cameras saw."""
    known = {
        "geometry": GEOMETRY,
        "edges": EDGES,
        "blobs": (BLOB,),
        "lines": LINES,
        "circles": (CIRCLE,),
        "objects": (BALL, GOAL, MARKER),
        "lines_3d": (SeenLine3D(start_mm=(0, 0, 300), end_mm=(100, 50, 500), left_line=1, right_line=0),),
        "edges_3d": SeenEdges3D(
            places_mm=np.array([[10, 20, 300], [-10, 5, 1500]], np.int32),
            left_edges=np.array([0, 2], np.int32),
        ),
    }
    return Seen(camera="left", picture=grey(), **{**known, **changes})  # type: ignore[arg-type]


def frame(index: int = 4, *cameras: Seen, time_ns: int = 500_000_000) -> SeenFrame:
    """A frame of both cameras; the right picture is 2 ms later."""
    return SeenFrame(
        index=index,
        times_ns={"left": time_ns, "right": time_ns + 2_000_000},
        cameras=cameras or (left(), Seen(camera="right", picture=grey(), geometry=GEOMETRY)),
    )
