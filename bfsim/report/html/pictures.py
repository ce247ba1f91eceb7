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
"""Of all pictures of a page together: with 100 frames in it, what is around them leaves so much of 8 MB."""
HEAT_SHARE = 0.35
"""Of these for the heat maps: they have smooth colours and few words."""

_PANEL_WIDTH = 640
"""Of a camera's picture: a page shows it no larger, and words are read more easily than in one that is made smaller."""


class Pictures:
    """The overlay of each frame of a run and its heat map, as small as a page of `frames` of them needs it. A context manager.

    They are drawn behind the run, and all there after `finish`. Raises ConfigError where there is no room for its file.
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
        """Have pictures of so many frames on the page from now on."""
        self._small, self._small_heat = overlay_shrinker(frames), Shrinker(_room_bytes(HEAT_SHARE, frames))

    def add(self, frame: SeenFrame) -> None:
        """Draw what was seen in a frame."""
        self._behind.do(partial(self._draw, frame))

    def add_with_heat(self, frame: SeenFrame) -> None:
        """Draw what was seen in a frame whose cameras have their heat, and the heat."""
        self.add(replace(frame, cameras=tuple(replace(each, heat=None) for each in frame.cameras)))
        self._behind.do(partial(self._draw_heat, frame))

    def finish(self) -> None:
        """Wait until all is drawn."""
        self._behind.finish()

    def _draw(self, frame: SeenFrame) -> None:
        self._overlays.put(frame.index, overlay_webp(frame, self._small))

    def _draw_heat(self, frame: SeenFrame) -> None:
        self._heats.put(frame.index, self._small_heat.webp_of(overlay_of(frame, UNDER_HEAT, _PANEL_WIDTH)))

    def has_overlay(self, index: int) -> bool:
        """Whether a frame was seen."""
        return index in self._overlays

    def overlay_uri(self, index: int) -> str:
        """Return what was seen in a frame as an address that holds the picture."""
        return picture_uri(self._overlays[index])

    def has_heat(self, index: int) -> bool:
        """Whether there is a heat map of a frame: there is none of one that was cut short."""
        return index in self._heats

    def heat_uri(self, index: int) -> str:
        """Return the heat map of a frame as an address that holds the picture."""
        return picture_uri(self._heats[index])


def overlay_shrinker(frames: int) -> Shrinker:
    """Return what makes overlays small enough for a page of so many frames."""
    return Shrinker(_room_bytes(1 - HEAT_SHARE, frames))


def overlay_webp(frame: SeenFrame, shrinker: Shrinker) -> bytes:
    """Return what was seen in a frame as WebP."""
    return shrinker.webp_of(overlay_of(frame, LAYERS, _PANEL_WIDTH))


def picture_uri(content: bytes) -> str:
    """Return a picture as an address that holds it."""
    return f"data:image/webp;base64,{b64encode(content).decode()}"


def _room_bytes(share: float, frames: int) -> int:
    """Return how large a picture may be; as an address it is a third larger."""
    return int(share * PAGE_BYTES * 3 // 4 // frames)
