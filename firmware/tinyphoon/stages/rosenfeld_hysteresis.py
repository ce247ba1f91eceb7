"""Edge detection with hysteresis as in T §5.2.1: a variation of Rosenfeld's segmentation over the suppressed picture.

[said] The finished line of the non-maximum suppression goes back to SDRAM by DMA while the
next ones are made; groups of connected edges without a strong one are removed afterwards;
what stays is in the store of Listing 5.1 (T §5.2.1). [implied] So the picture comes through
L1 twice more: to be labelled, and to lose its weak groups. [assumed] The store takes the
edges during the scan, from the top of the picture, until it is full, and closes up when
groups are removed; labels go to a picture of their own in SDRAM and come back by DMA.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from bfsim.api import Core, Frame, OutputRing, Row, i32, kernel, u8, u16
from tinyphoon.areas import WHOLE_PICTURE, Area
from tinyphoon.stages.edge_detection import EdgeThresholds, RowSteps, scan
from tinyphoon.stages.edge_storing import store_edges_row
from tinyphoon.stages.hysteresis import (
    LABELS,
    EdgeGroups,
    clear_labels,
    group_of,
    join_groups,
    keep_edges_row,
    known_label,
    new_label,
)
from tinyphoon.stages.strong_gradients import STRONG_FIRST
from tinyphoon.stores.edges import EDGE_CAPACITY, edge_columns, edge_store


@kernel
def group_pixels_row(
    edges: u8[:], above: u16[:], here: u16[:], groups: u16[:], strongest: u8[:], given: i32
) -> i32:
    """Label the edges of a row of the picture and join groups that meet, as `group_edges_row` does in the store."""
    last = len(groups) - 1
    here[0] = 0
    for x in range(1, len(edges) - 1):
        label = 0
        if edges[x] != 0:
            label = known_label(above, here, x)
            if label == 0:
                label = new_label(given, last)
                given = given + 1
                if given <= last:
                    groups[label] = label
                    strongest[label] = 0
            elif above[x] == 0 and above[x + 1] != 0:
                join_groups(groups, strongest, label, above[x + 1])
            group = group_of(groups, label)
            strongest[group] = max(strongest[group], edges[x])
        here[x] = label
    here[len(edges) - 1] = 0
    return given


@dataclass(slots=True)
class PictureEdges:
    """Receives the edges of a scan: gradients go to `edge_image`, edges to the store. Replaces `Candidates`."""

    core: Core
    picture: OutputRing
    found: int = 0

    def row(self) -> Generator[Any, Any, Row]:
        """Return a row for gradients."""
        return (yield from self.picture.row())

    def add(self, y: int, gradients: Row, directions: Row) -> Generator[Any, Any, None]:
        """Keep the edges of row `y`: its pixels with a gradient."""
        self.found = yield self.core.run(
            store_edges_row, gradients, directions, *edge_store(self.core), y, self.found
        )
        self.picture.send()


def rosenfeld_edges(
    core: Core,
    frame: Frame,
    thresholds: EdgeThresholds,
    area: Area = WHOLE_PICTURE,
    steps: RowSteps = STRONG_FIRST,
) -> Generator[Any, Any, int]:
    """Detect the edges of a picture and reduce its colours; leave and publish the same as `edge_detection`.

    When the store is full, the edges further down are lost.
    """
    edges = PictureEdges(core, core.output_ring("edge_ring", core.rows("edge_image")))
    yield from scan(core, frame, thresholds, area, edges, steps)
    yield from edges.picture.flush()
    groups = EdgeGroups.of(core, frame.width)
    given = yield from label_edges(groups, frame.height)
    kept = yield from remove_weak(groups, frame.height, thresholds.strong_threshold)
    lost = max(0, edges.found - EDGE_CAPACITY)
    core.publish(edges=kept, edges_lost=lost, edge_groups_shared=max(0, given - LABELS + 1))
    return kept


def label_edges(groups: EdgeGroups, height: int) -> Generator[Any, Any, int]:
    """Label the edges of the picture, a line at a time; leave `label_image`, return how many labels were wanted."""
    core = groups.core
    picture = core.input_ring(core.rows("edge_image"), "edge_ring")
    labels = core.output_ring("label_ring", core.rows("label_image"))
    above = core.rows("label_ring")[-1]
    yield core.run(clear_labels, above)
    given = 0
    for y in range(height):
        core.at(y)
        line = yield from picture.line()
        here = yield from labels.row()
        given = yield core.run(group_pixels_row, line, above, here, *groups.tables, given)
        labels.send()
        above = here
    core.at()
    yield from labels.flush()
    return given


def remove_weak(groups: EdgeGroups, height: int, strong_threshold: int) -> Generator[Any, Any, int]:
    """Remove the groups without a strong edge from the store and from `edge_image`; return how many edges are kept."""
    core = groups.core
    labels = core.input_ring(core.rows("label_image"), "label_ring")
    picture = core.output_ring("edge_ring", core.rows("edge_image"))
    kept = 0
    for y in range(height):
        core.at(y, edge_columns, groups.store, y)
        line = yield from labels.line()
        row = yield from picture.row()
        decided = line, *groups.tables, strong_threshold
        kept = yield core.run(keep_edges_row, *decided, row, *groups.store, y, kept)
        picture.send()
    core.at()
    yield from picture.flush()
    return kept
