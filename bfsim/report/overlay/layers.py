"""The layers of an overlay: which of the things seen are drawn."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from functools import reduce

from bfsim.seen import Seen, SeenFrame, no_edges, no_edges_3d

_WITHOUT: Mapping[str, Callable[[Seen], Seen]] = {
    "edges": lambda seen: replace(seen, edges=no_edges(), edges_3d=no_edges_3d()),
    "blobs": lambda seen: replace(seen, blobs=()),
    "lines": lambda seen: replace(seen, lines=(), lines_3d=()),
    "circles": lambda seen: replace(seen, circles=()),
    "objects": lambda seen: replace(seen, objects=()),
    "losses": lambda seen: replace(seen, losses=()),
    "arrows": lambda seen: replace(seen, arrows=()),
    "texts": lambda seen: replace(seen, texts=()),
    "map": lambda seen: replace(seen, map=None),
}

ABOVE = "above"
"""The view from above, beside the pictures."""

LAYERS = (*_WITHOUT, ABOVE)
"""Everything that can be drawn over the pictures, and beside them."""

UNDER_HEAT = ("objects",)
"""The default layers over heat, which is to stay visible."""


def only(frame: SeenFrame, layers: Collection[str]) -> SeenFrame:
    """Return a frame with only those things seen that are in `layers`."""
    hidden = [without for name, without in _WITHOUT.items() if name not in layers]
    cameras = (reduce(lambda left, without: without(left), hidden, seen) for seen in frame.cameras)
    return replace(frame, cameras=tuple(cameras))
