"""Modes: the thresholds that the strategy unit sets for the place it plays in (T §5.2.6)."""

from __future__ import annotations

from dataclasses import dataclass

from firmware.line_store import SUBPIXELS
from firmware.stages.blob_detection import BlobThresholds, hues
from firmware.stages.edge_detection import EdgeThresholds
from firmware.stages.line_detection import LineThresholds
from firmware.stages.line_refinement import RefinementThresholds
from firmware.stages.stereo_edges import StereoEdgeThresholds
from firmware.stages.stereo_lines import Correspondence, StereoLineThresholds


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """The thresholds of every stage. They depend on lighting and cameras, never on one picture."""

    edges: EdgeThresholds
    blobs: BlobThresholds
    lines: LineThresholds
    refinement: RefinementThresholds
    stereo_lines: StereoLineThresholds
    stereo_edges: StereoEdgeThresholds


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
    refinement=RefinementThresholds(
        # An edge is as wide as the lens and the pixels blur it: three pixels to both sides are enough, and few enough
        # to keep other edges out.
        reach=3,
        # Six times the noise, and half of the least step that makes an edge.
        min_step=6,
    ),
    stereo_lines=StereoLineThresholds(
        correspondence=Correspondence.MUTUAL,
        # 11 degrees. A line whose ends are 100 and 200 mm deep is turned by less from one picture to the other.
        angle_range=8,
        # The tangent of 22.5 degrees: the rows of flatter lines say little about columns.
        min_rise=106,
        # From the far end of the field, 5 m, to what both cameras just see, 9 cm.
        min_disparity=2 * SUBPIXELS,
        max_disparity=128 * SUBPIXELS,
        # A line that is cut in one picture may lack half.
        min_common=128,
    ),
    stereo_edges=StereoEdgeThresholds(
        correspondence=Correspondence.MUTUAL,
        # 22.5 degrees, as for lines.
        level_range=16,
        # As for lines; noise turns single edges more.
        direction_range=8,
        # 10 cm to 1.5 m: what is in the way soon. More pixels find more edges by chance.
        min_disparity=8,
        max_disparity=116,
    ),
)
"""A FIRA field lit from above in a dark room, as in the recording that comes with bfsim, in pictures of 320x240."""
