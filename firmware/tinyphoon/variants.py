"""Other steps for the same features: faster ones, and those that the thesis describes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from bfsim.api import Buffer, Buffers, Calibration, FrameSize
from tinyphoon.buffers import buffers, with_geometry
from tinyphoon.core_a import core_a
from tinyphoon.core_b import core_b
from tinyphoon.features import Steps
from tinyphoon.fields import to_words
from tinyphoon.stages.circle_erosion import eroded_circles, shape_buffers
from tinyphoon.stages.colour_reduction import single_colours
from tinyphoon.stages.fast_opening import fast_opening
from tinyphoon.stages.fast_scan import fast_edge_detection, fast_scan_buffers
from tinyphoon.stages.feature_rectification import feature_rectification, picture_as_it_came
from tinyphoon.stages.line_ends import scan_by_ends
from tinyphoon.stages.looped_erosion import looped_buffers
from tinyphoon.stages.rectified_places import places_buffers
from tinyphoon.stages.rosenfeld_blobs import SEGMENTS, rosenfeld_blobs, rosenfeld_buffers
from tinyphoon.stages.rosenfeld_hysteresis import rosenfeld_edges
from tinyphoon.stages.sdram_opening import sdram_opening
from tinyphoon.stages.sdram_rectification import sdram_rectification, sdram_rectification_buffers, untouched
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.strategy.models import model_words
from tinyphoon.strategy.modes import THESIS_FIELD

FAST = Steps(edge_detection=fast_edge_detection, open_closing=fast_opening)
THESIS = Steps(
    rectification=sdram_rectification,
    colour_groups=single_colours,
    edge_detection=rosenfeld_edges,
    open_closing=sdram_opening,
    blob_detection=rosenfeld_blobs,
    line_scan=scan_by_ends,
    circle_detection=eroded_circles,
)
RECTIFIED_FEATURES = Steps(rectification=picture_as_it_came, feature_rectification=feature_rectification)

THESIS_ORDERS = {
    "ordered_mode": np.array(to_words(THESIS_FIELD)),
    "ordered_models": model_words(THESIS_FIELD.models),
}
"""The mode in force before the first message of the strategy unit."""


def mains(steps: Steps) -> Mapping[str, partial]:
    """Return the main loops of both cores with these steps."""
    return {"A": partial(core_a, steps=steps), "B": partial(core_b, steps=steps)}


def fast_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """Return the buffers of each core for pictures of `size`."""
    return buffers(size, fast_scan_buffers)


def thesis_buffers(size: FrameSize) -> Mapping[str, Sequence[Buffer]]:
    """Return the buffers of each core for pictures of `size`."""
    of_core = dict(buffers(size))
    for core, images in (("A", "sdram_bank2"), ("B", "sdram_bank3")):
        records = (
            replace(each, columns=SEGMENTS * BLOB_WORDS) if each.name == "blob_data" else each
            for each in of_core[core]
        )
        more = *rosenfeld_buffers(size, images), *shape_buffers(size, images), *looped_buffers()
        of_core[core] = (*records, *more)
    of_core["shared"] = tuple(
        replace(each, values=THESIS_ORDERS[each.name]) if each.name in THESIS_ORDERS else each
        for each in of_core["shared"]
    )
    return of_core


def places_calibration(calibration: Calibration) -> Buffers:
    """Return the buffers for a recording's cameras: where pixels lie in rectified pictures, and the geometry."""
    return with_geometry(places_buffers(calibration.sources), calibration)


def thesis_calibration(calibration: Calibration) -> Buffers:
    """Return the buffers for a recording's cameras: every picture has a table, and the geometry."""
    size = calibration.size
    sources = calibration.sources or ({core: untouched(size) for core in ("A", "B")} if size else {})
    return with_geometry(sdram_rectification_buffers(sources), calibration)
