"""Modes: the thresholds that the strategy unit sets for the place it plays in (T §5.2.6)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """Thresholds of the vision. They depend on lighting and cameras, never on one picture.

    `gauss_px`: size of the Gauss before the edge detection, 3 or 5. `edge_threshold`: the tau_e and the tau_l of
    T §2.1.4 in one, and `strong_threshold`: its tau_h, that one edge of a group must reach; both in stored gradient
    units, a quarter of a Sobel gradient; 1..255.
    `eps_black`, `eps_white`: limits of luma minus chroma in grey levels (T Eq. 5.2); -182..255. A pixel
    below the first is black, above the second white, and has a hue between them.
    """

    gauss_px: Literal[3, 5]
    edge_threshold: int
    strong_threshold: int
    eps_black: int
    eps_white: int


INDOOR_FIELD = Mode(
    gauss_px=3,
    # A step of h grey levels has the gradient 3/4 h behind the Gauss: steps of 11 levels and more are edges.
    # The noise of the cameras stays near 1.
    edge_threshold=8,
    # Twice the low one: what is seen somewhere with 22 levels is followed down to 11.
    strong_threshold=16,
    # An unlit room and a dark floor reach 27 and are no objects; what is coloured on the field (ball, goals,
    # markers) has medians of 50 and more.
    eps_black=28,
    # Lines and walls under the field's lamps start at 103 and are mostly far brighter; the lit side of the
    # ball reaches 121 and must keep its colour.
    eps_white=125,
)
"""A FIRA field lit from above in a dark room, as in the recording that comes with bfsim."""
