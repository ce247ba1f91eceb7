"""How core A gets the results of core B: core B copies them to the L2 memory that both share, and posts.

X of core B is `right_X` there; its edges are stored there from the start. Core A waits for the post before it reads,
and core B waits for core A's before it writes again. A store to L2 is posted and costs a core next to nothing; a load
waits for its latency each time, so core A first copies what it reads often into its L1.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

from bfsim.api import Buffer, Core, FrameSize, Row, i16, i32, kernel, u16, u32
from tinyphoon.stages.line_segments import SEGMENT_CAPACITY
from tinyphoon.stores.edges import EDGE_CAPACITY
from tinyphoon.stores.lines import LINE_WORDS

SHARED = "l2_shared"


def exchange_buffers(size: FrameSize) -> Sequence[Buffer]:
    """Return the shared buffers: lines and edges of the right picture, and their numbers."""
    return (
        Buffer("right_lines", i16, LINE_WORDS * SEGMENT_CAPACITY, SHARED, handed_over=True),
        Buffer("right_line_count", u32, 1, SHARED, handed_over=True),
        Buffer("right_edge_data", u32, EDGE_CAPACITY, SHARED, handed_over=True),
        # first edge of a row in bits 0..15, count in 16..31
        Buffer("right_edge_rows", u32, size.height_px, SHARED, handed_over=True),
        Buffer("right_edges", u32, 1, SHARED, handed_over=True),
    )


@kernel
def copy_words(source: u32[:], target: u32[:], count: i32) -> None:
    """Copy the first `count` words."""
    for word in range(count):
        target[word] = source[word]


@kernel
def store_word(words: u32[:], value: i32) -> None:
    """Store a number in a variable that the other core reads."""
    words[0] = value


@kernel
def load_word(words: u32[:]) -> i32:
    """Load a number that the other core has stored."""
    return i32(words[0])


@kernel
def pack_edge_rows(edge_index: u32[:], edge_counts: u16[:], edge_rows: u32[:]) -> None:
    """Pack first edge and count of each row into one word, so that core A waits for L2 once a row."""
    for y in range(len(edge_rows)):
        edge_rows[y] = edge_index[y] | u32(edge_counts[y]) << 16


def as_words(core: Core, name: str) -> Row:
    """Return a buffer, all its rows together, as 32-bit words."""
    return core.overlay(name, u32, sum(each.nbytes for each in core.rows(name)) // 4)[0]


def share(
    core: Core, name: str, record_nbytes: int, count_name: str, count: int
) -> Generator[Any, Any, None]:
    """Copy the first `count` records of core B's buffer `name` to `right_name`, and store `count` in `count_name`.

    The buffer has a whole number of 32-bit words.
    """
    words = (count * record_nbytes + 3) // 4
    yield core.run(copy_words, as_words(core, name), as_words(core, f"right_{name}"), words)
    yield core.run(store_word, core.array(count_name), count)


def shared_count(core: Core, count_name: str) -> Generator[Any, Any, int]:
    """Return the count that core B has stored in `count_name`."""
    count: int = yield core.run(load_word, core.array(count_name))
    return count


def share_lines(core: Core, lines: int) -> Generator[Any, Any, None]:
    """Share the lines of core B's picture."""
    yield from share(core, "lines", 2 * LINE_WORDS, "right_line_count", lines)


def share_edges(core: Core, edges: int) -> Generator[Any, Any, None]:
    """Share the edge store of core B's picture: only where its rows begin, for the edges are there already."""
    yield core.run(store_word, core.array("right_edges"), edges)
    index, counts = core.array("edge_index"), core.array("edge_counts")
    yield core.run(pack_edge_rows, index, counts, core.array("right_edge_rows"))
