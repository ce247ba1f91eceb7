"""The depth in the message of a frame: 3-D lines and 3-D edges (T §5.2.7 to §5.2.9), as many as the mode allows.

The thesis wants them for self-localization and for obstacles, but does not say how they are sent: layout and choice are
[ours]. A 3-D line is six words, X, Y and Z of start and end in mm in the left camera's frame, with the bright side on
its left as in the picture; a 3-D edge is three. If there is no room for all lines, those that begin lowest in the
picture are sent, since these are nearest on the floor; of too many edges, every n-th is sent, so that the rest of the
cloud covers the whole picture. The message also says how many there were.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.api import i16, i32, kernel, u16
from tinyphoon.fields import allowed
from tinyphoon.stores.lines3d import EDGE3D_WORDS, EDGE3D_X, EDGE3D_Z, LINE3D_WORDS, LINE3D_X0, LINE3D_Z1
from tinyphoon.strategy.framing import HEADER_WORDS

LINE3D_REPORT_WORDS = LINE3D_Z1 - LINE3D_X0 + 1
EDGE3D_REPORT_WORDS = EDGE3D_Z - EDGE3D_X + 1
LINES_3D_CAPACITY = 64
EDGES_3D_CAPACITY = 128

# In the payload, beside the other counts.
LINES_3D = 7  # how many follow
EDGES_3D = 8
LINES_3D_FOUND = 9  # how many there were
EDGES_3D_FOUND = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportLimits:
    """The most 3-D lines and 3-D edges in a message; 0 for none."""

    lines_3d: int = allowed(0, LINES_3D_CAPACITY)
    edges_3d: int = allowed(0, EDGES_3D_CAPACITY)


@kernel
def pack_lines_3d(message: u16[:], words: i32, lines_3d: i16[:], count: i32, most: i32) -> i32:
    """Append the last `most` of `count` 3-D lines to a payload of `words` words; return its new length."""
    first = max(count - most, 0)
    to = HEADER_WORDS + words
    for line in range(first, count):
        for word in range(LINE3D_REPORT_WORDS):
            message[to + word] = lines_3d[line * LINE3D_WORDS + LINE3D_X0 + word]
        to = to + LINE3D_REPORT_WORDS
    message[HEADER_WORDS + LINES_3D] = count - first
    message[HEADER_WORDS + LINES_3D_FOUND] = count
    return to - HEADER_WORDS


@kernel
def pack_edges_3d(message: u16[:], words: i32, edges_3d: i16[:], count: i32, most: i32) -> i32:
    """Append `most` of `count` 3-D edges, evenly chosen, to a payload of `words` words; return its new length."""
    sent = min(count, most)
    to = HEADER_WORDS + words
    for number in range(sent):
        edge = number * count // sent * EDGE3D_WORDS
        for word in range(EDGE3D_REPORT_WORDS):
            message[to + word] = edges_3d[edge + EDGE3D_X + word]
        to = to + EDGE3D_REPORT_WORDS
    message[HEADER_WORDS + EDGES_3D] = sent
    message[HEADER_WORDS + EDGES_3D_FOUND] = count
    return to - HEADER_WORDS
