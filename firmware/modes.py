"""Modes: the thresholds that the strategy unit sets for the place it plays in (T §5.2.6)."""

from __future__ import annotations

from dataclasses import dataclass

from firmware.models import MODELS, colour_groups
from firmware.stages.blob_detection import BlobThresholds
from firmware.stages.edge_detection import EdgeThresholds
from firmware.stages.line_detection import LineThresholds


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """The thresholds of every stage. They depend on lighting and cameras, never on one picture."""

    edges: EdgeThresholds
    blobs: BlobThresholds
    lines: LineThresholds


INDOOR_FIELD = Mode(
    edges=EdgeThresholds(
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
    ),
    blobs=BlobThresholds(
        colour_groups=colour_groups(MODELS),
        # A mark of 5 cm that is 3 m away still has 6 x 6 pixels; what is smaller is a reflection or noise.
        min_pixels=36,
        # Half a picture of 320x240 in one colour is no object but a camera that has not settled (T Figure 6.8).
        max_pixels=38_400,
        max_blobs=64,
    ),
    lines=LineThresholds(
        # A sixteenth of a turn, the finer partition of Burns's line detector (T §2.2.1). With 12 the stairs of drawn
        # edges break one line in fifty.
        angle_range=16,
        mean_edges=8,
        min_length=8,
        near_angle=8,
        near_gap=4,
        # Twice this and lines of cluttered pictures are connected that have nothing to do with each other.
        muff_range=4,
        far_gap=24,
    ),
)
"""A FIRA field lit from above in a dark room, as in the recording that comes with bfsim, in pictures of 320x240."""
