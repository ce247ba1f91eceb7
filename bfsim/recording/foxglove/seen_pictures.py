"""What was seen in a picture, as the messages that Foxglove draws over it."""

from __future__ import annotations

from collections.abc import Iterable

from foxglove_schemas_protobuf.CircleAnnotation_pb2 import CircleAnnotation
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from foxglove_schemas_protobuf.Point2_pb2 import Point2
from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from foxglove_schemas_protobuf.TextAnnotation_pb2 import TextAnnotation
from PIL import Image

from bfsim.seen import Colour, Point, Seen, SeenBlob, SeenHeat, SeenObject, colours
from bfsim.seen.heat import heated
from bfsim.seen.pictures import rgb_of

THICKNESS_PX = 1.0
POINT_PX = 0.6
FONT_PX = 9.0


def image_message(seen: Seen, time_ns: int) -> RawImage:
    """Return the picture that a core looked at, in an encoding that every viewer takes."""
    return _image(seen, rgb_of(seen.picture), time_ns)


def heat_message(seen: Seen, heat: SeenHeat, hottest_us: float, time_ns: int) -> RawImage:
    """Return the same picture under its heat; the scale ends at `hottest_us` a row."""
    return _image(seen, heated(rgb_of(seen.picture), heat, hottest_us), time_ns)


def _image(seen: Seen, picture: Image.Image, time_ns: int) -> RawImage:
    image = RawImage(
        frame_id=seen.camera,
        width=seen.width_px,
        height=seen.height_px,
        encoding="rgb8",
        step=3 * seen.width_px,
        data=picture.tobytes(),
    )
    image.timestamp.FromNanoseconds(time_ns)
    return image


def features_message(seen: Seen, objects: Iterable[SeenObject], time_ns: int) -> ImageAnnotations:
    """Return the marks of a picture: edges, blobs, lines, circles, and the objects that this camera shows."""
    edges = zip(seen.edges.x_px.tolist(), seen.edges.y_px.tolist(), strict=True)
    ends = [point for line in seen.lines for point in (line.start_px, line.end_px)]
    message = ImageAnnotations(
        points=[
            _points(PointsAnnotation.POINTS, edges, colours.EDGE, POINT_PX),
            _points(PointsAnnotation.LINE_LIST, ends, colours.LINE, THICKNESS_PX),
            *(
                _points(PointsAnnotation.LINE_LOOP, _corners(each), each.colour, THICKNESS_PX)
                for each in seen.blobs
            ),
        ],
        circles=[
            CircleAnnotation(
                position=_point(each.centre_px),
                diameter=2 * each.radius_px,
                thickness=THICKNESS_PX,
                outline_color=color(colours.CIRCLE if each.passed else colours.FAILED),
            )
            for each in seen.circles
        ],
        texts=[_caption(each) for each in objects if each.camera == seen.camera],
    )
    message.timestamp.FromNanoseconds(time_ns)
    return message


def color(colour: Colour, alpha: float = 1.0) -> Color:
    """Return a colour in Foxglove's form, 0 to 1."""
    red, green, blue = colour
    return Color(r=red / 255, g=green / 255, b=blue / 255, a=alpha)


def _points(
    kind: PointsAnnotation.Type.ValueType, points: Iterable[Point], colour: Colour, thickness_px: float
) -> PointsAnnotation:
    return PointsAnnotation(
        type=kind,
        points=[_point(each) for each in points],
        outline_color=color(colour),
        thickness=thickness_px,
    )


def _point(point: Point) -> Point2:
    """Return a point in Foxglove's coordinates, from the corner of the first pixel rather than its middle."""
    return Point2(x=point[0] + 0.5, y=point[1] + 0.5)


def _corners(blob: SeenBlob) -> list[Point]:
    left, top, right, bottom = (
        blob.left_px - 0.5,
        blob.top_px - 0.5,
        blob.right_px + 0.5,
        blob.bottom_px + 0.5,
    )
    return [(left, top), (right, top), (right, bottom), (left, bottom)]


def _caption(each: SeenObject) -> TextAnnotation:
    (x, y), (width, height) = each.image_px, each.image_size_px
    return TextAnnotation(
        position=_point((x - width / 2, y - height / 2 - 1)),
        text=each.caption,
        font_size=FONT_PX,
        text_color=color(each.colour),
        background_color=color((0, 0, 0), 0.6),
    )
