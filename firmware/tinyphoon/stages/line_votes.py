"""Which 3-D lines to believe: the 3-D edges on a line vote on its depth [ours].

Lines are few and similar: two lines of one pattern agree in rows and angle though they show different things. Edges are
many, and each was matched independently of the line. In every row that a line crosses, an edge with a partner that lies
on the line votes for it if it has the line's disparity there, and against it if it has another.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

from bfsim.api import Core, Row, i16, i32, kernel, u32
from tinyphoon.stages.line_correspondence import column_at
from tinyphoon.stores.lines import LINE_WORDS, LINE_Y0, LINE_Y1, SUBPIXELS
from tinyphoon.stores.lines3d import LINE3D_LEFT, LINE3D_RIGHT, LINE3D_WORDS


@kernel
def clear_votes(votes: i32[:]) -> None:
    """Begin to count."""
    for number in range(len(votes)):
        votes[number] = 0


@kernel
def majority_at(
    left_row: u32[:],
    left_count: i32,
    disparities: i16[:],
    column: i32,
    disparity: i32,
    edge_range: i32,
) -> i32:
    """Return by how many the edges of a row within `edge_range` of a line's `column` are for it rather than against it.

    They are for it if their disparity is within the same range of the line's. All in 1/16 px, except `disparities`: by
    column, in pixels plus 1, or 0 or less for none.
    """
    majority = 0
    for left in range(left_count):
        x = i32(left_row[left] >> 16)
        if SUBPIXELS * x > column + edge_range:
            break
        if SUBPIXELS * x >= column - edge_range and disparities[x] > 0:
            off = SUBPIXELS * (i32(disparities[x]) - 1) - disparity
            majority = majority + 1 if abs(off) <= edge_range else majority - 1
    return majority


@kernel
def vote_row(
    lines_3d: i16[:],
    count: i32,
    lines: i16[:],
    slopes: i32[:],
    others: i16[:],
    other_slopes: i32[:],
    y: i32,
    left_row: u32[:],
    left_count: i32,
    disparities: i16[:],
    votes: i32[:],
    edge_range: i32,
) -> None:
    """Add the votes of row `y` for each of `count` 3-D lines that cross it.

    `left_row` has the row's edges, and `disparities` theirs by column plus 1, in pixels, or 0 or less for none.
    """
    row = SUBPIXELS * y
    for number in range(count):
        line = i32(lines_3d[number * LINE3D_WORDS + LINE3D_LEFT])
        y0 = lines[line * LINE_WORDS + LINE_Y0]
        y1 = lines[line * LINE_WORDS + LINE_Y1]
        if min(y0, y1) <= row <= max(y0, y1):
            other = i32(lines_3d[number * LINE3D_WORDS + LINE3D_RIGHT])
            column = column_at(lines, line, slopes, row)
            disparity = column - column_at(others, other, other_slopes, row)
            votes[number] = votes[number] + majority_at(
                left_row, left_count, disparities, column, disparity, edge_range
            )


@kernel
def keep_elected(lines_3d: i16[:], count: i32, votes: i32[:]) -> i32:
    """Leave out those of `count` 3-D lines without a majority; return how many stay."""
    kept = 0
    for number in range(count):
        if votes[number] > 0:
            for word in range(LINE3D_WORDS):
                lines_3d[kept * LINE3D_WORDS + word] = lines_3d[number * LINE3D_WORDS + word]
            kept = kept + 1
    return kept


@dataclass(frozen=True, slots=True)
class LineVote:
    """The vote on the first `count` 3-D lines: opened, given the edges row by row, and closed.

    `left` and `right` are the lines of each picture and their slopes. With an `edge_range` of 0 there is no vote.
    """

    core: Core
    count: int
    left: tuple[Row, Row]
    right: tuple[Row, Row]
    votes: Row
    edge_range: int

    def open(self) -> Generator[Any, Any, None]:
        """Begin to count."""
        yield self.core.run(clear_votes, self.votes)

    def add(self, y: int, row: tuple[Row, int, Row]) -> Generator[Any, Any, None]:
        """Let the edges of row `y` vote: those of the left picture, their number, and their disparities by column."""
        if self.count and self.edge_range:
            lines = self.core.array("lines_3d"), self.count, *self.left, *self.right
            yield self.core.run(vote_row, *lines, y, *row, self.votes, self.edge_range)

    def close(self) -> Generator[Any, Any, int]:
        """Keep the elected lines in `lines_3d`. Publishes `lines_3d`, their number, and returns it."""
        kept = self.count
        if self.edge_range:
            kept = yield self.core.run(keep_elected, self.core.array("lines_3d"), self.count, self.votes)
        self.core.publish(lines_3d=kept)
        return kept
