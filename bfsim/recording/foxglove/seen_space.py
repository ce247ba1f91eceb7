"""What was seen in space, as the messages that Foxglove draws in its 3-D view. Lengths there are metres.

Frames: `left` and `right` are the cameras (x to the right, y down, z forward), `floor` is on the ground under the left
one (x forward, y to the left, z up).
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.KeyValuePair_pb2 import KeyValuePair
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3

from bfsim.recording.foxglove.seen_pictures import color
from bfsim.seen import PointMm, SeenEdges3D, SeenGeometry, SeenLine3D, SeenObject, Solid
from bfsim.seen.colours import ROOM

LEFT, RIGHT, FLOOR = "left", "right", "floor"

MM = 0.001
LINE_PX = 2.0
FONT_M = 0.03
DIRECTION_M = 1.0
"""The length to draw for an object of which only the direction is known."""

FAINTEST = 0.3
"""Opacity of an object of accuracy 0."""


def transforms_message(geometry: SeenGeometry, time_ns: int) -> FrameTransforms:
    """Return where the cameras are."""
    half = math.radians(geometry.tilt_deg) / 2
    down, up = (math.cos(half) + math.sin(half)) / 2, (math.cos(half) - math.sin(half)) / 2
    left = FrameTransform(
        parent_frame_id=FLOOR,
        child_frame_id=LEFT,
        translation=Vector3(z=geometry.height_mm * MM),
        # from a camera's axes to the floor's, then down round the axis that points left
        rotation=Quaternion(x=-down, y=down, z=-up, w=up),
    )
    right = FrameTransform(
        parent_frame_id=LEFT,
        child_frame_id=RIGHT,
        translation=Vector3(x=geometry.baseline_mm * MM),
        rotation=Quaternion(w=1),
    )
    for each in (left, right):
        each.timestamp.FromNanoseconds(time_ns)
    return FrameTransforms(transforms=[left, right])


def calibration_message(
    geometry: SeenGeometry, camera: str, size_px: tuple[int, int], time_ns: int
) -> CameraCalibration:
    """Return the calibration of a rectified camera."""
    width, height = size_px
    focal, (x, y) = geometry.focal_px, geometry.principal_px
    shift = -focal * geometry.baseline_mm * MM if camera == RIGHT else 0.0
    message = CameraCalibration(
        frame_id=camera,
        width=width,
        height=height,
        K=[focal, 0, x, 0, focal, y, 0, 0, 1],
        R=[1, 0, 0, 0, 1, 0, 0, 0, 1],
        P=[focal, 0, x, shift, 0, focal, y, 0, 0, 0, 1, 0],
    )
    message.timestamp.FromNanoseconds(time_ns)
    return message


def objects_message(objects: Iterable[SeenObject], tilt_deg: float, time_ns: int) -> SceneUpdate:
    """Return the objects: spheres and upright boxes of their models' sizes, or lines if only the direction is known."""
    # a turn round the axis to the right, so that boxes stand upright before a camera that looks down
    half = math.radians(tilt_deg) / 2
    upright = Quaternion(x=math.sin(half), w=math.cos(half))
    return _update((_object(number, each, upright) for number, each in enumerate(objects)), time_ns)


def _object(number: int, each: SeenObject, upright: Quaternion) -> SceneEntity:
    colour = color(each.colour, FAINTEST + (1 - FAINTEST) * each.accuracy)
    place = np.array(each.place_mm) * MM
    if each.is_direction:
        place *= DIRECTION_M / np.linalg.norm(place)
    width, height = each.width_mm * MM, each.height_mm * MM
    above = Pose(position=_vector(place - (0, height / 2 + FONT_M, 0)), orientation=Quaternion(w=1))
    words = TextPrimitive(pose=above, billboard=True, font_size=FONT_M, color=colour, text=each.caption)
    entity = SceneEntity(id=f"{number} {each.name}", texts=[words])
    for key, value in (("accuracy", f"{each.accuracy:.3f}"), ("tests", ", ".join(each.tests)),
                       ("age_frames", str(each.age_frames))):  # fmt: skip
        entity.metadata.append(KeyValuePair(key=key, value=value))
    pose = Pose(position=_vector(place), orientation=upright)
    if each.is_direction:
        entity.lines.append(_line([(0, 0, 0), tuple(place / MM)], colour))
    elif each.solid is Solid.SPHERE:
        size = Vector3(x=width, y=height, z=width)
        entity.spheres.append(SpherePrimitive(pose=pose, size=size, color=colour))
    else:  # models have no depth
        size = Vector3(x=width, y=height, z=min(width, height))
        entity.cubes.append(CubePrimitive(pose=pose, size=size, color=colour))
    return entity


def lines_message(lines: Iterable[SeenLine3D], time_ns: int) -> SceneUpdate:
    """Return the lines in space, each in the colour of its depth."""
    entities = (
        SceneEntity(
            id=f"line {each.left_line}",
            lines=[
                _line(
                    [each.start_mm, each.end_mm],
                    color(ROOM.colour((each.start_mm[2] + each.end_mm[2]) / 2)),
                )
            ],
        )
        for each in lines
    )
    return _update(entities, time_ns)


def edges_message(edges: Iterable[SeenEdges3D], time_ns: int) -> PointCloud:
    """Return the edges in space, with red, green, blue and alpha by depth."""
    places = [place for each in edges for place in each.places_mm.tolist()]
    points = np.zeros(len(places), [("place", "<f4", 3), ("colour", "u1", 4)])
    if places:
        points["place"] = np.array(places) * MM
        points["colour"] = [(*ROOM.colour(depth), 255) for _, _, depth in places]
    fields = [("x", 0), ("y", 4), ("z", 8)]
    colours = [("red", 12), ("green", 13), ("blue", 14), ("alpha", 15)]
    message = PointCloud(
        frame_id=LEFT,
        pose=Pose(position=Vector3(), orientation=Quaternion(w=1)),
        point_stride=points.itemsize,
        fields=[
            *(
                PackedElementField(name=name, offset=at, type=PackedElementField.FLOAT32)
                for name, at in fields
            ),
            *(
                PackedElementField(name=name, offset=at, type=PackedElementField.UINT8)
                for name, at in colours
            ),
        ],
        data=points.tobytes(),
    )
    message.timestamp.FromNanoseconds(time_ns)
    return message


def _update(entities: Iterable[SceneEntity], time_ns: int) -> SceneUpdate:
    """Return an update that replaces all earlier entities by these, in the left camera's frame."""
    message = SceneUpdate(deletions=[SceneEntityDeletion(type=SceneEntityDeletion.ALL)], entities=entities)
    for each in (*message.deletions, *message.entities):
        each.timestamp.FromNanoseconds(time_ns)
    for entity in message.entities:
        entity.frame_id = LEFT
    return message


def _line(points_mm: Iterable[PointMm], colour: Color) -> LinePrimitive:
    return LinePrimitive(
        type=LinePrimitive.LINE_STRIP,
        pose=Pose(position=Vector3(), orientation=Quaternion(w=1)),
        thickness=LINE_PX,
        scale_invariant=True,
        points=[Point3(x=x * MM, y=y * MM, z=z * MM) for x, y, z in points_mm],
        color=colour,
    )


def _vector(place: Iterable[float]) -> Vector3:
    x, y, z = map(float, place)
    return Vector3(x=x, y=y, z=z)
