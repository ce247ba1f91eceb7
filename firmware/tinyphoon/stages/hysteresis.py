"""Hysteresis: the fifth step of the Canny, by Rosenfeld grouping of the edges (T §2.1.4, §2.3.3, §5.2.1).

While the picture is scanned, edges that touch (8-neighbourhood) get one label, and
labels that meet become one group. Afterwards a short pass over the edge store, not
over the picture, removes the edges of the groups that have no strong edge. The
labels are not kept: they would take half as much memory as the edge store. A label
depends only on the edges before it, so this pass labels every edge once more.

`groups` is the equivalence table: the label that each label belongs to, never a greater one; a group goes by its
least label. `strongest` is the greatest gradient of each group, under that label. Label 0 is no edge.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bfsim.api import Buffer, Core, Row, i32, kernel, u8, u16, u32
from tinyphoon.stores.edges import edge_columns, edge_store

# Noise makes most of the groups: the rendered scenes of the thesis need up to 724 labels. These are too few only if the
# edge store is full of specks of 5 edges and less.
LABELS = 1536


@kernel
def clear_labels(labels: u16[:]) -> None:
    """Make a row of labels without edges."""
    for x in range(len(labels)):
        labels[x] = 0


@kernel
def known_label(above: u16[:], here: u16[:], x: i32) -> i32:
    """Return the label that the edge at `x` takes over from an edge before it, or 0 if it touches none."""
    if above[x] != 0:
        return above[x]
    if here[x - 1] != 0:
        return here[x - 1]
    if above[x - 1] != 0:
        return above[x - 1]
    return above[x + 1]


@kernel
def new_label(given: i32, last: i32) -> i32:
    """Return the label after `given` others. When there are too many, labels share the last one."""
    return min(given + 1, last)


@kernel
def group_of(groups: u16[:], label: i32) -> i32:
    """Return the group of a label, and shorten the path to it (path compression)."""
    group = label
    while groups[group] != group:
        group = groups[group]
    while groups[label] != group:
        onward = groups[label]
        groups[label] = group
        label = onward
    return group


@kernel
def join_groups(groups: u16[:], strongest: u8[:], one: i32, other: i32) -> None:
    """Join the groups of two labels."""
    one = group_of(groups, one)
    other = group_of(groups, other)
    low = min(one, other)
    high = max(one, other)
    groups[high] = low
    strongest[low] = max(strongest[low], strongest[high])


@kernel
def group_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    above: u16[:],
    here: u16[:],
    groups: u16[:],
    strongest: u8[:],
    given: i32,
) -> i32:
    """Label the stored edges of row `y` and join groups that meet there; return how many labels the picture has needed.

    `above` and `here` are the labels of the row before and of this one, `given` is the number before this row. When
    `groups` is full, all further labels are its last one. No edge lies in the first or the last column.
    """
    clear_labels(here)
    last = len(groups) - 1
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        x = i32(edge >> 16)
        label = known_label(above, here, x)
        if label == 0:
            label = new_label(given, last)
            given = given + 1
            if given <= last:
                groups[label] = label
                strongest[label] = 0
        elif above[x] == 0 and above[x + 1] != 0:  # the only case in which two groups can meet
            join_groups(groups, strongest, label, above[x + 1])
        here[x] = label
        group = group_of(groups, label)
        strongest[group] = max(strongest[group], i32(edge & 255))
    return given


@kernel
def label_edges_row(
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    above: u16[:],
    here: u16[:],
    last: i32,
    given: i32,
) -> i32:
    """Give the stored edges of row `y` the labels of `group_edges_row` again; return how many there are so far."""
    clear_labels(here)
    first = i32(edge_index[y])
    for position in range(first, first + edge_counts[y]):
        x = i32(edge_data[position] >> 16)
        label = known_label(above, here, x)
        if label == 0:
            label = new_label(given, last)
            given = given + 1
        here[x] = label
    return given


@kernel
def keep_edges_row(
    labels: u16[:],
    groups: u16[:],
    strongest: u8[:],
    strong_threshold: i32,
    edges: u8[:],
    edge_data: u32[:],
    edge_index: u32[:],
    edge_counts: u16[:],
    y: i32,
    kept: i32,
) -> i32:
    """Keep the stored edges of row `y` whose group has a strong one, and write them to `edges`, with 0 elsewhere.

    The store closes up in place: `kept` is the number of edges that the rows before keep; return it with this row.
    """
    for x in range(len(edges)):
        edges[x] = 0
    first = i32(edge_index[y])
    edge_index[y] = kept
    for position in range(first, first + edge_counts[y]):
        edge = edge_data[position]
        x = i32(edge >> 16)
        if strongest[group_of(groups, labels[x])] >= strong_threshold:
            edge_data[kept] = edge
            edges[x] = edge & 255
            kept = kept + 1
    edge_counts[y] = kept - i32(edge_index[y])
    return kept


def hysteresis_buffers() -> Sequence[Buffer]:
    """Return the tables of the groups. Only kernels use them, so one may lie where no DMA reaches."""
    return (
        Buffer("edge_groups", u16, LABELS, "L1_scratch"),
        Buffer("edge_strongest", u8, LABELS, "L1_data_b"),
    )


@dataclass(frozen=True, slots=True)
class EdgeGroups:
    """The edge store, the tables of its groups, and two lines of labels.

    `labels`: of even lines, and of odd ones, those of the line before and their own.
    """

    core: Core
    store: tuple[Row, Row, Row]
    tables: tuple[Row, Row]
    labels: tuple[tuple[Row, Row], tuple[Row, Row]]

    @classmethod
    def of(cls, core: Core, width: int) -> EdgeGroups:
        """Return those of a core. The lines share a ring that only later stages use."""
        even, odd, *_ = core.overlay("eroded_ring", u16, width)
        tables = core.array("edge_groups"), core.array("edge_strongest")
        return cls(core, edge_store(core), tables, ((odd, even), (even, odd)))


def hysteresis(groups: EdgeGroups, height: int, strong_threshold: int) -> Generator[Any, Any, int]:
    """Remove the stored edges without a strong one in their group; leave `edge_image`, return how many are kept.

    The edge image is written from the store. Clearing removed edges in a picture written during the scan would need the
    same lines of DMA twice more, there and back, and leave edges in it that the store had no room for.
    """
    run, at, store = groups.core.run, groups.core.at, groups.store
    edges = groups.core.output_ring("edge_ring", groups.core.rows("edge_image"))
    (data, index, counts), (table, strongest), last = store, groups.tables, LABELS - 1
    given = kept = 0
    for y in range(height):
        at(y, edge_columns, store, y)
        above, here = groups.labels[y & 1]
        row = yield from edges.row()
        if y == 0:
            yield run(clear_labels, above)
        given = yield run(label_edges_row, data, index, counts, y, above, here, last, given)
        kept = yield run(
            keep_edges_row, here, table, strongest, strong_threshold, row, data, index, counts, y, kept
        )
        edges.send()
    at()
    yield from edges.flush()
    return kept
