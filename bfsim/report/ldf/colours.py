"""A hue for each kind of buffer, and a shade of it for each name: a buffer looks the same in every memory and core."""

from __future__ import annotations

import colorsys
from collections import Counter
from collections.abc import Mapping

from bfsim.report.ldf.map import ContentKind, MemoryMap

CODE_COLOUR = "#8c96a8"

HUES: Mapping[ContentKind, float] = {
    ContentKind.CAMERA: 0.36,
    ContentKind.LINES: 0.58,
    ContentKind.ROW: 0.10,
    ContentKind.TABLE: 0.83,
}
"""As fractions of a full turn: green, blue, orange, magenta."""

HUE_RANGE = 0.10
"""The range of hues of a kind: less than half of the distance between two kinds."""

LIGHTNESS, SATURATION = (0.60, 0.86), (0.40, 0.85)
"""Light enough for black letters."""

STEPS = 0.618034, 0.754878, 0.569840
"""Steps of these fractions spread any number of values evenly over a range, with neighbours far apart.

They are the golden section and its analogue for two dimensions [Roberts 2018, the R2 sequence].
"""


def colours_of(memory_map: MemoryMap) -> dict[str, str]:
    """Return a colour, #rrggbb, for the name of every piece that is neither free nor reserved."""
    colours: dict[str, str] = {}
    known: Counter[ContentKind] = Counter()
    for segment in memory_map.segments:
        for piece in segment.pieces:
            if piece.kind is ContentKind.CODE:
                colours[piece.name] = CODE_COLOUR
            elif piece.is_named and piece.name not in colours:
                colours[piece.name] = _shade(piece.kind, known[piece.kind])
                known[piece.kind] += 1
    return colours


def kind_colour(kind: ContentKind) -> str:
    """Return the colour that stands for a kind: that of its first buffer, or the single colour of code."""
    return CODE_COLOUR if kind is ContentKind.CODE else _shade(kind, 0)


def _shade(kind: ContentKind, number: int) -> str:
    """Return the colour of buffer `number` of its kind."""
    light, full, turn = ((0.5 + number * step) % 1 for step in STEPS)
    lightness, saturation = (
        low + part * (high - low) for part, (low, high) in ((light, LIGHTNESS), (full, SATURATION))
    )
    hue = (HUES[kind] + (turn - 0.5) * HUE_RANGE) % 1
    rgb = colorsys.hls_to_rgb(hue, lightness, saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in rgb)
