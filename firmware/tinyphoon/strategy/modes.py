"""Modes: the thresholds that the strategy unit sets for its place of play (T §5.2.6)."""

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
    """The thresholds of every stage, which suit the lighting and the cameras, and the area to look at."""

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
    # 1 px each for the smoothing before edges and colours, and what the opening takes off the outline.
    border=4,
    # 34 degrees. The centre of mass of half a disc lies 0.42 radii off the centre: from the outline, that is up to 25.
    angle_range=24,
    # A ball on a bright floor has a shadow there, whose border is as sharp as its own.
    beside_colour=True,
    # The centre of a half-hidden ball of 6 cm, 150 mm away, is this far from its centre of mass.
    patch_reach=32,
    peak_reach=1,
    # Half the outline of the smallest blob's 36 pixels.
    min_edges=12,
    # A quarter. Correct balls of the rendered scenes have 73 and more.
    centre_share=64,
    min_peak=12,
    # Of the correct rendered balls, all but one of 58 have 106 and more.
    radius_share=96,
    # Five eighths. Under half of the edges of squares and bars lie on a circle; three quarters of a cut ball's do.
    consensus_share=160,
    # In even light it stands still after three; from a lit half, 2 px off each time, up to eight to the whole.
    fit_rounds=8,
    # If the ball is dark below, the circle from the peaks is off by up to 2 px, and the edges lie as far inside.
    fit_range=3,
)
"""As fine as the picture allows [ours]."""

PLAIN_CIRCLES = replace(
    FITTED_CIRCLES,
    beside_colour=False,
    peak_reach=0,
    # Single cells and bins have about a third of the votes of three.
    centre_share=21,
    radius_share=32,
    fit_rounds=0,
)
"""The behaviour of the thesis: whole pixels, from peaks of single cells (T §5.2.4)."""

INDOOR_FIELD = Mode(
    edges=EdgeThresholds(
        gauss_px=3,
        # After the Gauss, a step of h grey levels has the gradient 3/4 h: steps of 11 levels and more are edges. The
        # noise of the cameras stays near 1.
        edge_threshold=8,
        # Twice the low one: an edge that reaches 22 levels somewhere is followed down to 11.
        strong_threshold=16,
        # An unlit room and a dark floor reach 27 and are no objects; coloured things on the field (ball, goals,
        # markers) have medians of 50 and more.
        eps_black=28,
        # Lines and walls under the field's lamps start at 103 and are mostly far brighter; the lit side of the ball
        # reaches 121 and must keep its colour.
        eps_white=125,
        # Half a hue is 6.4 degrees: at this chroma, three levels of noise in U or V turn a colour by as much. Light a
        # tenth too warm or too cold for the white balance gives a bright grey of 255 levels no more.
        least_chroma=28,
        # Cameras balance themselves; `bfsim colours` measures pictures that are not balanced.
        red_gain=AS_IT_IS,
        blue_gain=AS_IT_IS,
        # Twice the chroma in the shade keeps more than twice as many hues there (`docs/tinyphoon.md`), but finds no more
        # balls in a real hall, and four times as many false ones: wood and clothes are pale and dim.
        shade_gain=AS_IT_IS,
    ),
    # Noise is single pixels of a colour; one-pixel gaps in a thing do not split its blob.
    noise=NoiseRemoval(order=NoiseOrder.OPENING),
    blobs=BlobThresholds(
        colour_groups=colour_groups(MODELS),
        # A mark of 5 cm at 3 m still has 6 x 6 pixels; anything smaller is a reflection or noise.
        min_pixels=36,
        # Half a picture of 320x240 in one colour is no object but a camera that has not settled (T Figure 6.8).
        max_pixels=38_400,
        max_blobs=64,
        merged=True,
    ),
    lines=LineThresholds(
        # A sixteenth of a turn, the finer partition of Burns's line detector (T §2.2.1). With 12, the steps of drawn
        # edges break one line in fifty.
        angle_range=16,
        mean_edges=8,
        min_length=8,
        near_angle=8,
        near_gap=4,
        # With twice this, unrelated lines of cluttered pictures are connected.
        muff_range=4,
        far_gap=24,
    ),
    circles=FITTED_CIRCLES,
    rectangles=RectangleThresholds(
        # The opening rounds a blob's corners, and the edge lies where the colours change: the two are within 2 px of
        # each other; a leaning line needs as much again.
        border_px=4,
        # Of two lines, the one with a bright inside, unless it is twice as far away as lines usually are.
        dark_px=2,
        # Half a side: the other half may be hidden, or part of another line.
        overlap=128,
    ),
    objects=ObjectThresholds(
        # A blob alone gives a direction: a quarter. The shape, which places a ball, counts most. The second camera adds
        # less than any test: being seen by both does not make an object better.
        colour_weight=64,
        dimension_weight=32,
        area_weight=32,
        centre_weight=48,
        size_weight=48,
        camera_weight=31,
        # The mark of a robot is 50 mm high: 6 px at 3 m.
        shortest_side=6,
        # The row of its foot places it, and a few pixels of shade there shift it. Half as high again is something else.
        size_range=24,
        # Shade at a ball's foot and highlights on its top cover up to an eighth of it.
        ball_area=40,
        # A goal's mouth at 45 degrees fills three quarters; other whole rectangles fill two thirds.
        rectangle_area=160,
        # A third; a shorter arc says little about the centre.
        hidden_arc=85,
        # Rectified pictures agree in rows to a pixel, but the centres of partly hidden blobs do not.
        row_range=6,
        # A ball of 6 cm nearer than 15 cm is not whole in the picture: 386 px x 30.47 mm / 150 mm.
        disparity_max=78,
        # Twice the effect of one pixel of error in each picture.
        disparity_range=2,
        refined=True,
        # The radius of T Eq. 2.13 is that of an untested circle, and wrong if edges of other things are taken for its
        # outline; the square around the blob is always known.
        circle_area=False,
        # A second at 5 frames a second.
        age_max=5,
        # A robot that turns by 90 degrees a second turns by 18 degrees in a frame.
        apart_max=80,
    ),
    models=MODELS,
    refinement=RefinementThresholds(
        # Lens and pixels blur an edge over its width: three pixels on both sides are enough, and few enough to keep
        # other edges out.
        reach=3,
        # Six times the noise, and half of the smallest step that makes an edge.
        min_step=6,
    ),
    stereo_lines=StereoLineThresholds(
        correspondence=Correspondence.MUTUAL,
        # 11 degrees. A line whose ends are 100 and 200 mm deep turns less from one picture to the other.
        angle_range=8,
        # The tangent of 22.5 degrees: the rows of flatter lines say little about columns.
        min_rise=106,
        # As for edges.
        nearest_mm=100,
        farthest_mm=10_000,
        # A line that is cut in one picture may lack half.
        min_common=128,
        # A pixel and a half: edges are accurate to half a pixel in each picture, and lines likewise.
        edge_range=24,
    ),
    stereo_edges=StereoEdgeThresholds(
        correspondence=Correspondence.MUTUAL,
        # 22.5 degrees, as for lines.
        level_range=16,
        # 22.5 degrees. An upright edge on a plane whose disparity changes by two fifths of a pixel a row turns this
        # much from one picture to the other; noise turns single edges, too.
        direction_range=16,
        # No robot's lens is sharp nearer than 10 cm; no field or room is larger. Farther edges still take part in the
        # search and are dropped then.
        nearest_mm=100,
        farthest_mm=10_000,
        # Two gradients of one thing differ by this on noisy edges: 16 levels and 11 degrees.
        lack=32,
        # Three quarters of a row around it that agrees: of repeating patterns, only those with an end in reach.
        margin=24,
        # 22.5 degrees. Corners and noise turn single edges by as much; there are only few disparities to choose from.
        follow_range=16,
    ),
    # A frame of the soccer field has 10 to 20 lines with depth; a cloud of 64 has one edge in every square of 35 px.
    report=ReportLimits(lines_3d=32, edges_3d=64),
)
"""A FIRA field lit from above in a dark room, as in the recording of bfsim, in pictures of 320x240."""

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
    # T §5.2.7 and §5.2.8: the nearest with a similar direction
    stereo_lines=replace(INDOOR_FIELD.stereo_lines, correspondence=Correspondence.NEAREST, edge_range=0),
    stereo_edges=replace(
        INDOOR_FIELD.stereo_edges, correspondence=Correspondence.NEAREST, direction_range=8
    ),  # as for lines
)
"""The same field without what is [ours]."""
