"""Modes: the thresholds that the strategy unit sets for the place it plays in (T §5.2.6)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from firmware.stages.blob_detection import BlobThresholds, hues
from firmware.stages.circle_detection import CircleThresholds
from firmware.stages.edge_detection import EdgeThresholds
from firmware.stages.line_detection import LineThresholds


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """The thresholds of every stage. They depend on lighting and cameras, never on one picture."""

    edges: EdgeThresholds
    blobs: BlobThresholds
    lines: LineThresholds
    circles: CircleThresholds
    ball_colours: int
    """The colours of spherical models, as bits of the 32-colour image."""


FITTED_CIRCLES = CircleThresholds(
    # The smoothing before edges and colours, 1 px each, and what the opening takes off the outline.
    border=4,
    # 34 degrees. The centre of mass of half a disc lies 0.42 of the radius off the centre: seen from the outline up to 25.
    angle_range=24,
    # The floor is dark and the ball is lit: gradients that point away from it are those of mirror images and goals.
    dark_balls=False,
    # So far off its centre of mass is the centre of a ball of 6 cm that is hidden by half, 150 mm away.
    patch_reach=32,
    peak_reach=1,
    # Half the outline of the smallest blob's 36 pixels.
    min_edges=12,
    # A quarter. Balls of the rendered scenes that came out right have 73 and more.
    centre_share=64,
    min_peak=12,
    # Of the rendered balls that came out right all but one of 58 have 106 and more.
    radius_share=96,
    fit_rounds=4,
    # The circle from the peaks is off by up to 2 px where the ball is dark at the bottom, and its edges lie as far in.
    fit_range=3,
)
"""As fine as the picture allows [ours]."""

PLAIN_CIRCLES = replace(
    FITTED_CIRCLES,
    peak_reach=0,
    # Single cells and bins have about a third of what three have.
    centre_share=21,
    radius_share=32,
    fit_rounds=0,
)
"""The behaviour of the thesis: whole pixels, from peaks of single cells (T §5.2.4)."""

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
        # The hues of the recording's blue goal, yellow ball and red mark, each with the hue on either side: noise
        # and shade move a colour by one.
        colour_groups=(hues(9, 11), hues(21, 23), hues(25, 27)),
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
    circles=FITTED_CIRCLES,
    ball_colours=hues(21, 23),  # yellow, the second of the groups above
)
"""A FIRA field lit from above in a dark room, as in the recording that comes with bfsim, in pictures of 320x240."""
