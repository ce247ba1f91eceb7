"""Modes: the thresholds that the strategy unit sets for the place it plays in (T §5.2.6)."""

from __future__ import annotations

from dataclasses import dataclass, replace

from tinyphoon.areas import AS_RECORDED, WHOLE_PICTURE, Area, Camera
from tinyphoon.fields import not_ordered
from tinyphoon.stages.blob_detection import BlobThresholds
from tinyphoon.stages.circle_detection import CircleThresholds
from tinyphoon.stages.colour_reduction import AS_IT_IS
from tinyphoon.stages.edge_detection import EdgeThresholds
from tinyphoon.stages.line_detection import LineThresholds
from tinyphoon.stages.line_refinement import RefinementThresholds
from tinyphoon.stages.object_detection import ObjectThresholds
from tinyphoon.stages.open_closing import NoiseOrder, NoiseRemoval
from tinyphoon.stages.rectangle_detection import RectangleThresholds
from tinyphoon.stages.stereo_edges import StereoEdgeThresholds
from tinyphoon.stages.stereo_lines import Correspondence, StereoLineThresholds
from tinyphoon.strategy.depth_report import ReportLimits
from tinyphoon.strategy.models import (
    MODELS,
    THESIS_MODELS,
    ObjectModel,
    Shape,
    colour_groups,
    colours_of,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mode:
    """The thresholds of every stage, and what of the pictures is looked at. Thresholds depend on lighting and cameras, never on one picture."""

    edges: EdgeThresholds
    noise: NoiseRemoval
    blobs: BlobThresholds
    lines: LineThresholds
    circles: CircleThresholds
    rectangles: RectangleThresholds
    objects: ObjectThresholds
    models: tuple[ObjectModel, ...] = not_ordered()  # they have a message of their own
    refinement: RefinementThresholds
    stereo_lines: StereoLineThresholds
    stereo_edges: StereoEdgeThresholds
    report: ReportLimits
    camera: Camera = AS_RECORDED
    area: Area = WHOLE_PICTURE

    @property
    def ball_colours(self) -> int:
        """The colours of spheres."""
        return colours_of(self.models, Shape.BALL)

    @property
    def rectangle_colours(self) -> int:
        """The colours of rectangles."""
        return colours_of(self.models, Shape.GOAL, Shape.MARKER, Shape.BOX)

    @property
    def goal_colours(self) -> int:
        """The colours of goals."""
        return colours_of(self.models, Shape.GOAL)

    @property
    def has_boxes(self) -> bool:
        """Whether boxes are looked for."""
        return any(each.shape == Shape.BOX for each in self.models)


FITTED_CIRCLES = CircleThresholds(
    # The smoothing before edges and colours, 1 px each, and what the opening takes off the outline.
    border=4,
    # 34 degrees. The centre of mass of half a disc lies 0.42 of the radius off the centre: seen from the outline up to 25.
    angle_range=24,
    # A ball that stands on a bright floor has a shadow there, with a border as sharp as its own.
    beside_colour=True,
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
    # Five eighths. Of the edges of squares and bars not half lie on one circle; of balls cut by the border three quarters do.
    consensus_share=160,
    # In even light it stands still after three; from a lit half it takes up to eight, from each 2 px off to the whole.
    fit_rounds=8,
    # The circle from the peaks is off by up to 2 px where the ball is dark at the bottom, and its edges lie as far in.
    fit_range=3,
)
"""As fine as the picture allows [ours]."""

PLAIN_CIRCLES = replace(
    FITTED_CIRCLES,
    beside_colour=False,
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
        # Half a hue is 6.4 degrees: at this chroma a noise of three levels in U or V turns a colour by as much. And light
        # that is a tenth too warm or too cold for the camera's white balance gives a bright grey, of 255 levels, no more.
        least_chroma=28,
        # Cameras balance themselves; pictures that are not are measured by `bfsim colours`.
        red_gain=AS_IT_IS,
        blue_gain=AS_IT_IS,
        # Twice the chroma in the shade keeps more than twice as many hues there (`docs/tinyphoon.md`), but finds no more
        # balls in a real hall, and four times as many false ones: wood and clothes are pale and dim.
        shade_gain=AS_IT_IS,
    ),
    # Noise is single pixels of a colour; gaps of one pixel in a thing leave its blob whole.
    noise=NoiseRemoval(order=NoiseOrder.OPENING),
    blobs=BlobThresholds(
        colour_groups=colour_groups(MODELS),
        # A mark of 5 cm that is 3 m away still has 6 x 6 pixels; what is smaller is a reflection or noise.
        min_pixels=36,
        # Half a picture of 320x240 in one colour is no object but a camera that has not settled (T Figure 6.8).
        max_pixels=38_400,
        max_blobs=64,
        merged=True,
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
    rectangles=RectangleThresholds(
        # The opening rounds the corners of a blob and the edge lies where the colours change: within 2 px of each other;
        # as much again for a line that leans.
        border_px=4,
        # Of two lines, one of them bright inside, that one, unless it is twice as far off as lines usually are.
        dark_px=2,
        # Half a side: the other half may be hidden, or cut into another line.
        overlap=128,
    ),
    objects=ObjectThresholds(
        # A blob alone tells a direction: a quarter. The shape, which places a ball, counts most. The second camera adds less
        # than any test: what both see is no better an object for it.
        colour_weight=64,
        dimension_weight=32,
        area_weight=32,
        centre_weight=48,
        size_weight=48,
        camera_weight=31,
        # The mark of a robot is 50 mm high: 6 px at 3 m.
        shortest_side=6,
        # The row of its foot places it, and a few pixels of shade there move it. Half as high again is something else.
        size_range=24,
        # Shade at the foot of a ball and highlights on its top take up to an eighth of it.
        ball_area=40,
        # A goal's mouth at 45 degrees fills three quarters; two thirds of a whole rectangle otherwise.
        rectangle_area=160,
        # A third; a shorter arc tells little of the centre.
        hidden_arc=85,
        # Rectified pictures agree in rows to a pixel; the centres of blobs that are hidden in part do not.
        row_range=6,
        # A ball of 6 cm that is nearer than 15 cm is not in the picture as a whole: 386 px x 30.47 mm / 150 mm.
        disparity_max=78,
        # Twice what a pixel of error in each picture may be off.
        disparity_range=2,
        refined=True,
        # The radius of T Eq. 2.13 is that of a circle that has not been tested yet, and wrong where edges of other things are taken
        # for its outline; the square round the blob is always known.
        circle_area=False,
        # A second at 5 frames a second.
        age_max=5,
        # A robot that turns by 90 degrees a second turns by 18 degrees in a frame.
        apart_max=80,
    ),
    models=MODELS,
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
        # As for edges.
        nearest_mm=100,
        farthest_mm=10_000,
        # A line that is cut in one picture may lack half.
        min_common=128,
        # A pixel and a half: edges are found to half a pixel in each picture, and lines to as much.
        edge_range=24,
    ),
    stereo_edges=StereoEdgeThresholds(
        correspondence=Correspondence.MUTUAL,
        # 22.5 degrees, as for lines.
        level_range=16,
        # 22.5 degrees. An upright edge on a plane whose disparity changes by two fifths of a pixel a row is turned by so much
        # from one picture to the other; noise turns single edges, too.
        direction_range=16,
        # Nearer than 10 cm no robot's lens is sharp; farther than the largest field or room nobody plays. What is farther
        # still takes part in the search and is dropped then.
        nearest_mm=100,
        farthest_mm=10_000,
        # As much as two gradients of one thing differ on noisy edges: 16 levels and 11 degrees.
        lack=32,
        # Three quarters of a row around that agrees: of patterns that come again, only those with an end in reach.
        margin=24,
        # 22.5 degrees. Corners and noise turn single edges so far; there are few disparities to choose from, not the whole row.
        follow_range=16,
    ),
    # A frame of the soccer field has 10 to 20 lines with depth; a cloud of 64 has one edge in every 35 px square.
    report=ReportLimits(lines_3d=32, edges_3d=64),
)
"""A FIRA field lit from above in a dark room, as in the recording that comes with bfsim, in pictures of 320x240."""

THESIS_FIELD = replace(
    INDOOR_FIELD,
    edges=replace(INDOOR_FIELD.edges, least_chroma=0),  # T Eq. 5.2 alone
    blobs=replace(INDOOR_FIELD.blobs, colour_groups=colour_groups(THESIS_MODELS), merged=False),
    circles=PLAIN_CIRCLES,
    objects=replace(
        INDOOR_FIELD.objects, refined=False, hidden_arc=0, circle_area=True
    ),  # T Eq. 4.1, the mean of both cameras; T Eq. 2.13
    models=THESIS_MODELS,
    refinement=replace(INDOOR_FIELD.refinement, reach=0),
    # T §5.2.7 and §5.2.8: the nearest of like direction
    stereo_lines=replace(INDOOR_FIELD.stereo_lines, correspondence=Correspondence.NEAREST, edge_range=0),
    stereo_edges=replace(
        INDOOR_FIELD.stereo_edges, correspondence=Correspondence.NEAREST, direction_range=8
    ),  # as for lines
)
"""The same field without what is [ours]."""
