"""What was seen, and where in the picture the time went, as pictures that are small enough for a page."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import replace
from functools import partial
from typing import Self

from bfsim.files.spool import Spool
from bfsim.report.html.behind import Behind
from bfsim.report.html.shrinking import Shrinker
from bfsim.report.overlay.layers import LAYERS, UNDER_HEAT
from bfsim.report.overlay.overlay import overlay_of
from bfsim.seen import SeenFrame

PAGE_BYTES = 4_000_000
"""For all pictures of a page together: with 100 frames, everything around them leaves so much of 8 MB."""
HEAT_SHARE = 0.35
"""The heat maps' share of it: they have smooth colours and few words."""

_PANEL_WIDTH = 640
"""The width of a camera's picture: a page shows it no larger, and shrinking a larger one makes words harder to read."""


class Pictures:
    """The overlay and the heat map of each frame, small enough for a page of `frames` frames. A context manager.

    They are drawn while the run goes on, and all there after `finish`. Raises ConfigError if there is no room for its
    file.
    """

    def __init__(self) -> None:
        self.make_room(1)
        self._overlays = Spool()
        self._heats = Spool()
        self._behind = Behind()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._behind.__exit__()
        self._overlays.__exit__()
        self._heats.__exit__()

    def make_room(self, frames: int) -> None:
        """From now on, make pictures for a page of so many frames."""
        self._small, self._small_heat = overlay_shrinker(frames), Shrinker(_room_bytes(HEAT_SHARE, frames))

    def add(self, frame: SeenFrame) -> None:
        """Draw what was seen in a frame."""
        self._behind.do(partial(self._draw, frame))

    def add_with_heat(self, frame: SeenFrame) -> None:
        """Draw what was seen in a frame, and the heat, which its cameras have."""
        self.add(replace(frame, cameras=tuple(replace(each, heat=None) for each in frame.cameras)))
        self._behind.do(partial(self._draw_heat, frame))

    def finish(self) -> None:
        """Wait until everything is drawn."""
        self._behind.finish()

    def _draw(self, frame: SeenFrame) -> None:
        self._overlays.put(frame.index, overlay_webp(frame, self._small))

    def _draw_heat(self, frame: SeenFrame) -> None:
        self._heats.put(frame.index, self._small_heat.webp_of(overlay_of(frame, UNDER_HEAT, _PANEL_WIDTH)))

    def has_overlay(self, index: int) -> bool:
        """Whether a frame has an overlay."""
        return index in self._overlays

    def overlay_uri(self, index: int) -> str:
        """Return the overlay of a frame as a data URI."""
        return picture_uri(self._overlays[index])

    def has_heat(self, index: int) -> bool:
        """Whether a frame has a heat map: one that was cut short has none."""
        return index in self._heats

    def heat_uri(self, index: int) -> str:
        """Return the heat map of a frame as a data URI."""
        return picture_uri(self._heats[index])


def overlay_shrinker(frames: int) -> Shrinker:
    """Return a shrinker of overlays for a page of so many frames."""
    return Shrinker(_room_bytes(1 - HEAT_SHARE, frames))


def overlay_webp(frame: SeenFrame, shrinker: Shrinker) -> bytes:
    """Return what was seen in a frame as WebP."""
    return shrinker.webp_of(overlay_of(frame, LAYERS, _PANEL_WIDTH))


def picture_uri(content: bytes) -> str:
    """Return a picture as a data URI."""
    return f"data:image/webp;base64,{b64encode(content).decode()}"


def _room_bytes(share: float, frames: int) -> int:
    """Return how large a picture may be; as a URI it takes a third more."""
    return int(share * PAGE_BYTES * 3 // 4 // frames)
