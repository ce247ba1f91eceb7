"""The firmware with the features of the cameras' own pictures, rectified in place of the pictures (T §7.2).

    bfsim run --firmware tinyphoon.rectified_features:rectified_features

`stages/feature_rectification.py` says what it does. It stands apart from the other variants, which are imported together: it alone
needs its kernels, and the recordings that it is for have rectification tables.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.api import Buffers, Calibration, Readout, Seen
from tinyphoon import rows, tinyphoon
from tinyphoon.areas import area_in
from tinyphoon.buffers import with_geometry
from tinyphoon.features import Steps
from tinyphoon.stages.feature_rectification import feature_rectification, picture_as_it_came
from tinyphoon.stages.rectified_places import places_buffers
from tinyphoon.strategy.orders import mode_in
from tinyphoon.variants import mains
from tinyphoon.view.rectified_pictures import rectified_picture
from tinyphoon.view.view import view

STEPS = Steps(rectification=picture_as_it_came, feature_rectification=feature_rectification)


def places_calibration(calibration: Calibration) -> Buffers:
    """Return the buffers that depend on the cameras of a recording: where their pixels lie in rectified pictures, and the geometry."""
    return with_geometry(places_buffers(calibration.sources), calibration)


def rectified_view(readout: Readout) -> Seen:
    """Return what a core saw, over the rectified picture that its features lie in."""
    seen = view(readout)
    if not readout.has_buffer("places"):
        return seen
    mode = mode_in(readout.values("mode"), readout.values("models"))
    area = area_in(readout.frame, mode.area)
    return replace(seen, picture=rectified_picture(readout.picture(), readout.values("places"), area))


rectified_features = replace(
    tinyphoon,
    mains=mains(STEPS),
    calibration=places_calibration,
    rows=rows(rectified_in="Line detection"),
    view=rectified_view,
)
