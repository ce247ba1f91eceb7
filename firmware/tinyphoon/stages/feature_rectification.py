"""Features rectified in place of pictures (T §7.2): fewer points to move, and unchanged sharpness of edges and colours.

[said] Objects and lines are looked for in the pictures as the cameras have them, and the features are rectified for 3-D lines and for
the verification of objects. [implied] So all that these two read is moved: the edges, for they vote on 3-D lines and are 3-D edges
themselves, the lines, and the outlines of objects; and it is moved before a core tells the other one of it. [assumed] The thesis
says no more, and the robot never had it. Ours are: a coarse table (`rectified_places.py`); edges that stay whole pixels
(`rectified_edges.py`) and keep the directions of their gradients, which a lens may turn by 4 degrees in the corners, in both cameras
nearly alike; lines that are moved by points all along them (`rectified_lines.py`); circles by four points, blobs by their boxes
(`rectified_outlines.py`); an area of interest that is one of the camera's picture, of whose features those stay that lie in the
same area of the rectified one.

Without tables in the recording nothing is moved.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from bfsim.api import Core, Frame
from tinyphoon.areas import WHOLE_PICTURE, Area, area_in, cropped
from tinyphoon.stages.rectified_edges import rectified_edges
from tinyphoon.stages.rectified_lines import rectified_lines
from tinyphoon.stages.rectified_outlines import rectified_outlines
from tinyphoon.stages.rectified_places import look_from

if TYPE_CHECKING:
    from tinyphoon.features import Features


def picture_as_it_came(core: Core, frame: Frame, area: Area = WHOLE_PICTURE) -> Generator[Any, Any, Frame]:
    """Return the area of a picture as a frame, in place of `rectification`."""
    yield from ()
    return cropped(core, frame, area_in(frame, area))


def feature_rectification(core: Core, area: Area, found: Features) -> Generator[Any, Any, Features]:
    """Move the features of an area of a picture to their places in the rectified one; return them."""
    if not core.has_buffer("places"):
        return found
    with core.stage("Line detection"), core.stage("Rectification"):
        yield core.run(look_from, core.array("places"), area.x, area.y)
        yield from rectified_lines(core, found.frame, found.lines)
        yield from rectified_outlines(core, found.frame, found.outlines)
        edges = yield from rectified_edges(core, found.frame)
    return replace(found, edges=edges)
