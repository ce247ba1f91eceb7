"""One colour for each name in a memory map: the same buffer looks the same in every memory and on both cores."""

from __future__ import annotations

import colorsys

from bfsim.report.ldf.map import Kind, MemoryMap

CODE_COLOUR = "#8c96a8"
GOLDEN_TURN = 0.618034
"""Steps of this part of a turn spread hues evenly, however many there are."""

SHADES = ((0.60, 0.65), (0.52, 0.80), (0.72, 0.45))  # lightness and saturation, in turns
FIRST_HUE = 0.58


def colours_of(memory_map: MemoryMap) -> dict[str, str]:
    """Return a colour, #rrggbb, for the name of every piece that is not free or reserved."""
    colours: dict[str, str] = {}
    for segment in memory_map.segments:
        for piece in segment.pieces:
            if piece.kind is Kind.CODE:
                colours[piece.name] = CODE_COLOUR
            elif piece.is_named and piece.name not in colours:
                colours[piece.name] = _colour(len(colours))
    return colours


def _colour(number: int) -> str:
    lightness, saturation = SHADES[number % len(SHADES)]
    rgb = colorsys.hls_to_rgb((FIRST_HUE + number * GOLDEN_TURN) % 1, lightness, saturation)
    return "#" + "".join(f"{round(255 * part):02x}" for part in rgb)
