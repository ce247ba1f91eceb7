"""What was seen as an MCAP file: standard schemas, right times, and everything where it was seen."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.foxglove.seen_writer import SeenWriter
from bfsim.recording.writer import RecordingWriter
from tests import seen_frames as made

SCHEMAS = {
    "/transforms": "foxglove.FrameTransforms",
    "/camera/left/image_rect": "foxglove.RawImage",
    "/camera/left/calibration": "foxglove.CameraCalibration",
    "/camera/left/features": "foxglove.ImageAnnotations",
    "/camera/right/image_rect": "foxglove.RawImage",
    "/camera/right/calibration": "foxglove.CameraCalibration",
    "/camera/right/features": "foxglove.ImageAnnotations",
    "/seen/objects": "foxglove.SceneUpdate",
    "/seen/lines_3d": "foxglove.SceneUpdate",
    "/seen/edges_3d": "foxglove.PointCloud",
}


@pytest.fixture(name="path")
def _path(tmp_path: Path) -> Path:
    """A file of three frames."""
    path = tmp_path / "seen.mcap"
    with SeenWriter(path) as writer:
        for index in range(3):
            writer.add(made.frame(index, time_ns=1_000_000_000 + 33_000_000 * index))
    return path


def messages(path: Path) -> list[tuple[Any, Any, Any, Any]]:
    """Schema, channel, message and decoded message of all there is, as they stand in the file."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        return list(reader.iter_decoded_messages(log_time_order=False))


def first(path: Path) -> dict[str, Any]:
    """The first message of each topic."""
    found: dict[str, Any] = {}
    for _, channel, _, decoded in messages(path):
        found.setdefault(channel.topic, decoded)
    return found


def test_every_topic_has_a_standard_schema_and_a_message_per_frame(path: Path) -> None:
    """The schemas are Foxglove's, encoded as its protobufs with their descriptors."""
    counts: dict[str, int] = defaultdict(int)
    for schema, channel, _, _ in messages(path):
        assert (schema.encoding, channel.message_encoding) == ("protobuf", "protobuf")
        assert schema.name == SCHEMAS[channel.topic]
        counts[channel.topic] += 1
    assert counts == dict.fromkeys(SCHEMAS, 3)


def test_a_schema_is_told_once(path: Path) -> None:
    """However many topics have it."""
    names = [schema.name for schema in {each[0].id: each[0] for each in messages(path)}.values()]
    assert sorted(names) == sorted(set(SCHEMAS.values()))


def test_times_are_those_of_the_pictures_and_never_go_back(path: Path) -> None:
    """In the file as in the messages; the right camera's are its own."""
    last = 0
    for _, channel, message, decoded in messages(path):
        assert message.log_time == message.publish_time >= last
        last = message.log_time
        late = 2_000_000 if "right" in channel.topic else 0
        assert message.log_time == 1_000_000_000 + 33_000_000 * message.sequence + late
        for part in [*getattr(decoded, "transforms", ()), *getattr(decoded, "entities", ())] or [decoded]:
            if hasattr(part, "timestamp"):
                assert part.timestamp.ToNanoseconds() == message.log_time


def test_the_picture_is_what_the_core_looked_at(path: Path) -> None:
    """In the colours that Foxglove and rerun take: grey stays grey."""
    image = first(path)["/camera/left/image_rect"]
    assert (image.width, image.height, image.encoding, image.step) == (80, 60, "rgb8", 240)
    luma = made.grey()[:, 1::2]
    assert image.data == np.repeat(luma[..., None], 3, axis=2).tobytes()
    assert image.frame_id == "left"


def test_marks_count_from_the_corner_of_the_first_pixel(path: Path) -> None:
    """As the schema says; ours count from its middle."""
    marks = first(path)["/camera/left/features"]
    edges, lines, blob = marks.points
    assert (edges.type, lines.type) == (PointsAnnotation.POINTS, PointsAnnotation.LINE_LIST)
    assert [(each.x, each.y) for each in edges.points] == [(5.5, 50.5), (6.5, 50.5), (7.5, 51.5)]
    assert [(each.x, each.y) for each in lines.points[:2]] == [(60.5, 20.5), (60.5, 50.5)]
    assert [(each.x, each.y) for each in blob.points] == [(30, 20), (50, 20), (50, 40), (30, 40)]
    assert (marks.circles[0].position.x, marks.circles[0].diameter) == (40, 20)
    assert [each.text for each in marks.texts] == [made.BALL.caption, made.MARKER.caption]


def test_objects_are_bodies_of_their_models(path: Path) -> None:
    """A ball is a sphere, a goal a box, and what has only a direction a line of a metre that way."""
    update = first(path)["/seen/objects"]
    assert [each.type for each in update.deletions] == [SceneEntityDeletion.ALL]
    ball, goal, marker = update.entities
    assert {each.frame_id for each in update.entities} == {"left"}
    sphere, cube, line = ball.spheres[0], goal.cubes[0], marker.lines[0]
    assert vector(sphere.pose.position) == pytest.approx([0.03, 0.04, 1.2])
    assert vector(sphere.size) == pytest.approx([0.06, 0.06, 0.06])
    assert vector(cube.size) == pytest.approx([0.4, 0.1, 0.1])
    assert vector(line.points[0]) == pytest.approx([0, 0, 0])
    assert vector(line.points[1]) == pytest.approx([0, 0.6, 0.8])
    assert sphere.color.a > cube.color.a
    assert {each.key: each.value for each in goal.metadata} == {
        "accuracy": "0.500",
        "tests": "colour",
        "age_frames": "3",
    }


def test_lines_and_edges_in_space_are_metres(path: Path) -> None:
    """Lines with both ends, edges as the points of a cloud with the colours of their depths."""
    found = first(path)
    (line,) = found["/seen/lines_3d"].entities[0].lines
    assert [vector(each) for each in line.points] == [
        pytest.approx([0, 0, 0.3]),
        pytest.approx([0.1, 0.05, 0.5]),
    ]
    cloud = found["/seen/edges_3d"]
    assert [each.name for each in cloud.fields] == ["x", "y", "z", "red", "green", "blue", "alpha"]
    points = np.frombuffer(cloud.data, np.uint8).reshape(-1, cloud.point_stride)
    places = points[:, :12].copy().view("<f4")
    assert places == pytest.approx(np.array([[0.01, 0.02, 0.3], [-0.01, 0.005, 1.5]]))
    assert points[0, 12] > points[1, 12]  # red is near


def test_the_calibration_shows_places_where_they_were_seen(path: Path) -> None:
    """P takes a place in the left camera's frame to the pixels of either picture (T Eq. 3.16)."""
    place = np.array([0.1, -0.05, 0.8, 1.0])
    x_px = []
    for camera in ("left", "right"):
        projection = np.array(first(path)[f"/camera/{camera}/calibration"].P).reshape(3, 4)
        x, y, depth = projection @ place
        assert y / depth == pytest.approx(29.5 + 386 * -0.05 / 0.8)
        x_px.append(x / depth)
    assert x_px[0] == pytest.approx(39.5 + 386 * 0.1 / 0.8)
    assert x_px[0] - x_px[1] == pytest.approx(386 * 30.47 / 800)


def test_the_floor_is_where_the_camera_stands(path: Path) -> None:
    """Looking 10 degrees down from 120 mm, the axis meets the floor 120 / tan 10 mm ahead; boxes stand upright."""
    left, right = first(path)["/transforms"].transforms
    assert (left.parent_frame_id, left.child_frame_id, right.child_frame_id) == ("floor", "left", "right")
    turn = matrix(left.rotation)
    height = np.array(vector(left.translation))
    distance = 0.12 / np.sin(np.deg2rad(10))
    on_floor = height + turn @ [0, 0, distance]
    assert on_floor == pytest.approx([0.12 / np.tan(np.deg2rad(10)), 0, 0])
    assert turn @ [1, 0, 0] == pytest.approx([0, -1, 0])  # what is right of the camera is not left
    assert vector(right.translation) == pytest.approx([0.03047, 0, 0])
    goal = first(path)["/seen/objects"].entities[1].cubes[0]
    assert turn @ matrix(goal.pose.orientation) @ [0, 1, 0] == pytest.approx([0, 0, -1])


def test_without_geometry_there_is_no_guess(tmp_path: Path) -> None:
    """No transforms, no calibrations; the rest is there."""
    path = tmp_path / "seen.mcap"
    with SeenWriter(path) as writer:
        writer.add(made.frame(0, made.left(geometry=None), made.Seen(camera="right", picture=made.grey())))
    assert set(first(path)) == {
        each for each in SCHEMAS if "calibration" not in each and each != "/transforms"
    }


def test_a_frame_in_which_nothing_is_seen_takes_away_what_was_before(tmp_path: Path) -> None:
    """Its scene is empty, not missing."""
    path = tmp_path / "seen.mcap"
    empty = made.left(
        objects=(), lines_3d=(), edges_3d=made.Seen(camera="left", picture=made.grey()).edges_3d
    )
    with SeenWriter(path) as writer:
        writer.add(made.frame(0, empty))
    update = first(path)["/seen/objects"]
    assert len(update.deletions) == 1
    assert not update.entities
    assert not first(path)["/seen/edges_3d"].data


def test_an_error_leaves_no_file(tmp_path: Path, path: Path) -> None:
    """What was there before stays."""
    before = path.read_bytes()
    with pytest.raises(KeyboardInterrupt), SeenWriter(path) as writer:
        writer.add(made.frame())
        raise KeyboardInterrupt
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    assert path.read_bytes() == before
    with pytest.raises(RecordingError, match="must be a file, not a folder"):
        SeenWriter(tmp_path)


def test_only_what_an_earlier_run_saw_is_replaced(tmp_path: Path, path: Path) -> None:
    """A recording, above all the one that runs, is not written over."""
    with SeenWriter(path) as writer:
        writer.add(made.frame())
    assert len(messages(path)) == 10
    recording = tmp_path / "drive.mcap"
    with RecordingWriter(recording, width=2, height=2) as recorder:
        recorder.add(made.grey(2, 2), made.grey(2, 2), 0, 0)
    (tmp_path / "notes.mcap").write_text("notes")
    for other in (recording, tmp_path / "notes.mcap"):
        with pytest.raises(RecordingError, match="must be a new file or what an earlier run saw"):
            SeenWriter(other)


def test_numbers_of_a_frame_are_messages_with_a_schema_of_their_names(tmp_path: Path) -> None:
    """A reader that knows nothing of bfsim decodes them by the schemas in the file; zeros are numbers, too."""
    path = tmp_path / "seen.mcap"
    with SeenWriter(path) as writer:
        for index in (4, 7):
            writer.add(made.frame(index, time_ns=1_000 * index))
        for index in (4, 7):
            writer.add_numbers(index, "/cost/A/frame", "StageCost", {"elapsed_ms": index / 2, "idle_ms": 0.0})
            writer.add_numbers(index, "/cost/B/frame", "StageCost", {"elapsed_ms": 1.25, "idle_ms": 1e-6})
            writer.add_numbers(index, "/cost/frame", "FrameCost", {"latency_ms": 3.5})
    costs = [each for each in messages(path) if each[1].topic.startswith("/cost")]
    assert {(channel.topic, schema.name, schema.encoding) for schema, channel, _, _ in costs} == {
        ("/cost/A/frame", "bfsim.StageCost", "protobuf"),
        ("/cost/B/frame", "bfsim.StageCost", "protobuf"),
        ("/cost/frame", "bfsim.FrameCost", "protobuf"),
    }
    mine = [(message.log_time, decoded.frame, decoded.elapsed_ms, decoded.idle_ms)
            for _, channel, message, decoded in costs if channel.topic == "/cost/A/frame"]  # fmt: skip
    assert mine == [(4_000, 4, 2.0, 0.0), (7_000, 7, 3.5, 0.0)]


def test_warnings_are_lines_of_a_log(tmp_path: Path) -> None:
    """Of Foxglove's schema, at the time of their frame; remarks are information."""
    path = tmp_path / "seen.mcap"
    with SeenWriter(path) as writer:
        writer.add(made.frame(0, time_ns=5_000))
        writer.add_note(0, "lost: edges", is_warning=True)
        writer.add_note(0, "an order was taken", is_warning=False)
    notes = [each for each in messages(path) if each[1].topic == "/warnings"]
    assert [(schema.name, decoded.level, decoded.message) for schema, _, _, decoded in notes] == [
        ("foxglove.Log", Log.WARNING, "lost: edges"),
        ("foxglove.Log", Log.INFO, "an order was taken"),
    ]
    assert {decoded.timestamp.ToNanoseconds() for *_, decoded in notes} == {5_000}


def vector(message: Any) -> list[float]:
    """The x, y, z of a message."""
    return [message.x, message.y, message.z]


def matrix(quaternion: Any) -> NDArray[np.float64]:
    """The rotation of a unit quaternion, written out."""
    x, y, z, w = quaternion.x, quaternion.y, quaternion.z, quaternion.w
    assert x * x + y * y + z * z + w * w == pytest.approx(1)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])  # fmt: skip
