"""Other steps for the same features: faster ones, and those that the thesis describes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

from bfsim.api import Buffer, FrameSize
from tinyphoon.buffers import buffers
from tinyphoon.core_a import core_a
from tinyphoon.core_b import core_b
from tinyphoon.features import Steps
from tinyphoon.stages.fast_opening import fast_opening
from tinyphoon.stages.fast_scan import fast_edge_detection, fast_scan_buffers
from tinyphoon.stages.line_ends import scan_by_ends
from tinyphoon.stages.rosenfeld_blobs import SEGMENTS, rosenfeld_blobs, rosenfeld_buffers
from tinyphoon.stages.rosenfeld_hysteresis import rosenfeld_edges
from tinyphoon.stages.sdram_opening import sdram_opening
from tinyphoon.stores.blobs import BLOB_WORDS

FAST = Steps(edge_detection=fast_edge_detection, open_closing=fast_opening)
THESIS = Steps(
    edge_detection=rosenfeld_edges,
    open_closing=sdram_opening,
    blob_detection=rosenfeld_blobs,
    line_scan=scan_by_ends,
)


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
        of_core[core] = (*records, *rosenfeld_buffers(size, images))
    return of_core
