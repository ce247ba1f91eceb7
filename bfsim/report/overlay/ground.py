"""The ground of an overlay, under its marks: the picture, darkened and magnified, its map, its heat and its edges."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.report.overlay import style
from bfsim.seen import Seen, SeenEdges3D, SeenMap, colours
from bfsim.seen.colours import DepthScale
from bfsim.seen.heat import heated
from bfsim.seen.pictures import rgb_of

FULL_GRADIENT = 96  # edges as strong as this are drawn at their brightest
FAINTEST = 0.4
EDGE_SIDE = 0.6  # of the side of a pixel

MAP_SHARE = 0.45  # weight of a map's colour over the picture
MAP_STEPS = 4096  # from its first colour to its last: finer than 8 bits of red, green and blue can show


def picture_with_edges(
    seen: Seen, edges_3d: tuple[SeenEdges3D, ...], scale: int, depths: DepthScale, hottest_us: float
) -> NDArray[np.uint8]:
    """Return the picture, darkened and magnified, under its map, its heat, and a small square in each edge pixel."""
    size = (seen.width_px * scale, seen.height_px * scale)
    large = rgb_of(seen.picture).resize(size, Image.Resampling.BICUBIC).point(style.dark_levels())
    if seen.map:
        large = _with_map(large, seen.map)
    if seen.heat:
        large = heated(large, seen.heat, hottest_us)
    edges, picture = seen.edges, np.array(large)
    if not len(edges.y_px):
        return picture
    paint = np.zeros((seen.height_px, seen.width_px, 4), np.float32)
    paint[edges.y_px, edges.x_px, :3] = colours.EDGE
    paint[edges.y_px, edges.x_px, 3] = np.clip(edges.gradients / FULL_GRADIENT, FAINTEST, 1)
    for each in edges_3d:
        places = edges.y_px[each.left_edges], edges.x_px[each.left_edges]
        paint[(*places, slice(3))] = [depths.colour(depth) for depth in each.places_mm[:, 2]]
        paint[(*places, 3)] = 1
    y_px, x_px = (each.astype(np.int64) for each in (edges.y_px, edges.x_px))
    colour, share = np.split(paint[y_px, x_px], [3], axis=1)
    side = max(1, round(EDGE_SIDE * scale))
    for down, across in product(range((scale - side) // 2, (scale - side) // 2 + side), repeat=2):
        place = y_px * scale + down, x_px * scale + across
        before = picture[place].astype(np.float32)
        picture[place] = (before + (colour - before) * share).round()
    return picture


@cache
def _map_paints() -> NDArray[np.uint8]:
    """Return the colours of a map, RGBA: blue first."""
    share = round(255 * MAP_SHARE)
    steps = (1 - step / MAP_STEPS for step in range(MAP_STEPS + 1))
    return np.array([(*colours.scale_colour(each), share) for each in steps], np.uint8)


def _with_map(image: Image.Image, heat: SeenMap) -> Image.Image:
    """Return a picture under a map: blue for its least number, red for its greatest, nothing where there is none."""
    values = np.asarray(heat.values, float)
    known = values[np.isfinite(values)]
    if not known.size:
        return image
    low = float(known.min()) if heat.lowest is None else heat.lowest
    high = float(known.max()) if heat.highest is None else heat.highest
    parts = np.clip((values - low) / ((high - low) or 1.0), 0, 1)
    paint = np.zeros((*values.shape, 4), np.uint8)
    there = np.isfinite(values)
    paint[there] = _map_paints()[np.rint(parts[there] * MAP_STEPS).astype(int)]
    over = Image.fromarray(paint, "RGBA").resize(image.size, Image.Resampling.NEAREST)
    return Image.alpha_composite(image.convert("RGBA"), over).convert("RGB")
