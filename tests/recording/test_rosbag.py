"""`record import` of bags: which topics, which pairs, which pixels and times, and every bag that is not as it should be."""

from __future__ import annotations

import sys
import tracemalloc
from itertools import pairwise
from pathlib import Path
from random import Random

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from bfsim.cli.record import record
from bfsim.errors import RecordingError
from bfsim.recording import RecordingReader, RecordingWriter, StereoFrame
from bfsim.recording.importer import import_recording
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.ros_images import ENCODINGS
from bfsim.recording.time_pairs import nearest_pairs, rising
from tests.recording.bags import (
    EPOCH_NS,
    KINDS,
    LEFT,
    PERIOD_NS,
    RIGHT,
    Message,
    Ros,
    grey_pair,
    grey_rows,
)

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
each_kind = pytest.mark.parametrize("kind", KINDS)


def imported(path: Path, **how: object) -> list[StereoFrame]:
    """The frames that an import makes of a bag."""
    output = path.parent / "out.mcap"
    import_recording([path], output, force=True, **how)
    with RecordingReader(output) as reader:
        return list(reader.frames())


def greys(frames: list[StereoFrame]) -> list[tuple[int, int]]:
    """Brightness of the left and the right picture of each frame."""
    return [(int(each.left[0, 1]), int(each.right[0, 1])) for each in frames]


def run(*arguments: object) -> Result:
    """Run `bfsim record`."""
    return CliRunner().invoke(record, [str(each) for each in arguments])


# ---- pairs


@each_kind
def test_pairs_keep_their_pixels_and_times(kind: str, tmp_path: Path) -> None:
    """The first picture is at 0, and the right camera 3 ms behind."""
    path = Ros(kind).write(tmp_path, grey_pair(Ros(kind), range(5)))
    frames = imported(path)
    assert greys(frames) == [(10 + k, 100 + k) for k in range(5)]
    assert [(each.left_ns, each.right_ns) for each in frames] == [
        (k * PERIOD_NS, k * PERIOD_NS + 3_000_000) for k in range(5)
    ]
    assert all((each.left[:, ::2] == 128).all() for each in frames)


def test_a_single_file_of_ros_2_is_a_bag(tmp_path: Path) -> None:
    """Out of its folder, without metadata.yaml."""
    for kind in ("mcap", "db3"):
        folder = Ros(kind).write(tmp_path, grey_pair(Ros(kind), range(2)))
        (file,) = folder.glob(f"*.{kind}")
        assert len(imported(file)) == 2


@each_kind
def test_left_overs_are_listed(kind: str, tmp_path: Path) -> None:
    """A picture without a partner is in no pair, and the others stay together."""
    messages = grey_pair(Ros(kind), range(6))
    del messages[2 * 2], messages[2 * 4]  # the left one of frame 2, and the right one of frame 4
    path = Ros(kind).write(tmp_path, messages)
    assert greys(imported(path)) == [(10 + k, 100 + k) for k in (0, 1, 3, 5)]
    told = run("import", tmp_path / "told.mcap", path)
    assert told.exit_code == 0
    assert "4 stereo frames of 8x4 at" in told.output
    assert f"Skipped: {LEFT} 3: no picture of {RIGHT} within 20 ms" in told.output
    assert f"Skipped: {RIGHT} 2: no picture of {LEFT} within 20 ms" in told.output


def test_slop_is_the_limit_on_both_sides(tmp_path: Path) -> None:
    """3 ms apart: within 3 ms, and not within 2.9; without it, half a period."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(3)))
    assert len(imported(path, slop_s=0.003)) == 3
    with pytest.raises(
        RecordingError, match=r"must be within 2.9 ms of each other, .* nearest two are 3 ms apart; `--slop`"
    ):
        imported(path, slop_s=0.0029)
    late = tmp_path / "late"
    late.mkdir()
    path = ros.write(late, grey_pair(ros, range(3), right_after_ns=PERIOD_NS // 2))
    assert greys(imported(path)) == [(10, 100), (11, 101), (12, 102)]
    one = tmp_path / "one"
    one.mkdir()
    assert len(imported(ros.write(one, grey_pair(ros, [0], right_after_ns=16_000_000)))) == 1


def test_pictures_written_camera_by_camera_are_paired(tmp_path: Path) -> None:
    """The order in the bag does not matter."""
    ros = Ros("ros1")
    messages = grey_pair(ros, range(4))
    path = ros.write(tmp_path, [*messages[1::2], *messages[::2]])
    assert greys(imported(path)) == [(10 + k, 100 + k) for k in range(4)]


def test_a_time_stamp_that_goes_back_is_skipped(tmp_path: Path) -> None:
    """Of equal ones the first is taken."""
    ros = Ros("ros1")
    messages = grey_pair(ros, [0, 1, 1, 2])
    messages = [(*each[:2], EPOCH_NS + number, each[3]) for number, each in enumerate(messages)]
    path = ros.write(tmp_path, messages)
    summary = import_recording([path], tmp_path / "out.mcap")
    assert summary.frame_count == 3
    assert [each.name for each in summary.skipped] == [f"{LEFT} 2", f"{RIGHT} 2"]
    assert {each.reason for each in summary.skipped} == {"its time stamp is not later than those before"}


def test_pictures_without_time_stamps_go_by_the_bags_clock(tmp_path: Path) -> None:
    """And it is said."""
    ros = Ros("mcap")
    messages: list[Message] = [
        (topic, IMAGE, EPOCH_NS + k * PERIOD_NS + late_ns, ros.image(0, "mono8", grey_rows(k), 8))
        for k in range(3)
        for topic, late_ns in ((LEFT, 0), (RIGHT, 2_000_000))
    ]
    path = ros.write(tmp_path, messages)
    assert [(each.left_ns, each.right_ns) for each in imported(path)] == [
        (k * PERIOD_NS, k * PERIOD_NS + 2_000_000) for k in range(3)
    ]
    assert (
        "The pictures have no time stamps: they are paired by the times"
        in run("import", tmp_path / "a.mcap", path).output
    )


@given(*[st.lists(st.integers(0, 60), unique=True, max_size=12).map(sorted)] * 2, st.integers(0, 20))
def test_pairs_are_each_others_nearest(left: list[int], right: list[int], slop: int) -> None:
    """As a search through all pairs has it; none is used twice, and all rise."""
    numbers = nearest_pairs(np.array(left, np.int64), np.array(right, np.int64), slop)
    found = [(int(a), int(b)) for a, b in zip(*numbers, strict=True)]

    def nearest(time: int, others: list[int], tie: int) -> int:
        return min(range(len(others)), key=lambda each: (abs(others[each] - time), tie * each))

    expected = [
        (a, b)
        for a in range(len(left))
        for b in range(len(right))
        if abs(left[a] - right[b]) <= slop
        and nearest(left[a], right, -1) == b
        and nearest(right[b], left, 1) == a
    ]
    assert found == expected
    assert all(x[0] < y[0] and x[1] < y[1] for x, y in pairwise(found))


@given(st.lists(st.integers(0, 9)))
def test_rising_keeps_what_is_later_than_all_before(times: list[int]) -> None:
    """As a loop has it."""
    expected, last = [], -1
    for number, time in enumerate(times):
        if time > last:
            expected.append(number)
            last = time
    assert rising(np.array(times, np.int64)).tolist() == expected


# ---- pixels


def bytes_of(picture: NDArray[np.uint8], encoding: str) -> NDArray[np.uint8]:
    """Rows of an RGB picture (height, width, 3) as an encoding has them; YUV is of the same picture's planes."""
    height, width, _ = picture.shape
    full = np.full((height, width, 1), 77, np.uint8)
    uyvy = YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy()
    rows = {
        "rgb8": picture,
        "bgr8": picture[..., ::-1],
        "rgba8": np.concatenate([picture, full], axis=2),
        "bgra8": np.concatenate([picture[..., ::-1], full], axis=2),
        "uyvy": uyvy,
        "yuv422": uyvy,
        "yuyv": uyvy.reshape(height, width, 2)[..., ::-1],
        "yuv422_yuy2": uyvy.reshape(height, width, 2)[..., ::-1],
    }
    return np.ascontiguousarray(rows[encoding]).reshape(height, -1)


def one_pair(ros: Ros, message: object, kind: str = IMAGE) -> list[Message]:
    """One stereo frame of one picture."""
    return [(topic, kind, EPOCH_NS, message) for topic in (LEFT, RIGHT)]


@each_kind
@pytest.mark.parametrize(
    "encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "uyvy", "yuv422", "yuyv", "yuv422_yuy2"]
)
def test_colours_are_those_of_the_picture(kind: str, encoding: str, tmp_path: Path) -> None:
    """Whatever the order of their bytes, and with rows that are padded."""
    picture = np.random.default_rng(561).integers(0, 256, (6, 10, 3), np.uint8)
    rows = np.pad(bytes_of(picture, encoding), ((0, 0), (0, 5)))
    ros = Ros(kind)
    (frame,) = imported(ros.write(tmp_path, one_pair(ros, ros.image(EPOCH_NS, encoding, rows, 10))))
    assert np.array_equal(frame.left, YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy())
    assert np.array_equal(frame.right, frame.left)


@pytest.mark.parametrize(
    ("encoding", "corner"),
    [("bayer_rggb8", "rggb"), ("bayer_bggr8", "bggr"), ("bayer_gbrg8", "gbrg"), ("bayer_grbg8", "grbg")],
)
def test_a_bayer_pattern_of_one_colour_is_that_colour(encoding: str, corner: str, tmp_path: Path) -> None:
    """Each pixel of the pattern has its own colour's value."""
    values = {"r": 200, "g": 120, "b": 40}
    pattern = np.array([values[each] for each in corner], np.uint8).reshape(2, 2)
    ros = Ros("ros1")
    (frame,) = imported(
        ros.write(tmp_path, one_pair(ros, ros.image(EPOCH_NS, encoding, np.tile(pattern, (4, 5)), 10)))
    )
    expected = YuvPlanes.from_image(Image.new("RGB", (10, 8), (200, 120, 40))).to_uyvy()
    assert np.array_equal(frame.left, expected)


@pytest.mark.parametrize("encoding", ["mono16", "16UC1", "bayer_rggb16"])
@pytest.mark.parametrize("is_bigendian", [False, True])
def test_of_pixels_of_16_bits_the_upper_8_that_the_camera_uses_are_taken(
    encoding: str, is_bigendian: bool, tmp_path: Path
) -> None:
    """In either order of their bytes; in the same bag, a picture of 8 bits has none to spare."""
    pixels = np.full((4, 8), 0xC8F, ">u2" if is_bigendian else "<u2").view(np.uint8)
    ros = Ros("ros1")
    deep = ros.image(EPOCH_NS, encoding, pixels, 8, is_bigendian=is_bigendian)
    path = ros.write(tmp_path, [*one_pair(ros, deep), *grey_pair(ros, [1])])
    summary = import_recording([path], tmp_path / "out.mcap", bits=12)
    assert summary.frame_count == 1
    assert "must be one of mono16, 16UC1, bayer_rggb16, " in summary.skipped[0].reason
    with RecordingReader(tmp_path / "out.mcap") as reader:
        assert set(next(reader.frames()).left[:, 1::2].flat) == {0xC8}


@each_kind
@pytest.mark.parametrize("form", ["png", "jpeg"])
def test_compressed_pictures_are_decoded(kind: str, form: str, tmp_path: Path) -> None:
    """PNG to the bit, JPEG nearly, of one colour."""
    picture = Image.new("RGB", (16, 16), (200, 120, 40))
    ros = Ros(kind)
    messages = [
        (f"{topic}/compressed", COMPRESSED, EPOCH_NS, ros.compressed(EPOCH_NS, picture, form))
        for topic in (LEFT, RIGHT)
    ]
    (frame,) = imported(ros.write(tmp_path, messages))
    off = np.abs(frame.left.astype(int) - YuvPlanes.from_image(picture).to_uyvy())
    assert off.max() <= (2 if form == "jpeg" else 0)


def test_resize_and_one_camera(tmp_path: Path) -> None:
    """As of pictures from anywhere else."""
    ros = Ros("ros1")
    messages = [each for each in grey_pair(ros, range(3), size=(16, 8)) if each[0] == LEFT]
    path = ros.write(tmp_path, messages)
    frames = imported(path, mono=True, resize=(8, 4))
    assert greys(frames) == [(10 + k, 10 + k) for k in range(3)]
    assert (
        [each.left_ns for each in frames]
        == [each.right_ns for each in frames]
        == [0, PERIOD_NS, 2 * PERIOD_NS]
    )
    halves = imported(path, side_by_side=True, topics=(LEFT, LEFT))
    assert halves[0].left.shape == (8, 16)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ({"encoding": "rgb16"}, f"encoding must be one of {', '.join(ENCODINGS)}, not 'rgb16'"),
        (
            {"encoding": "mono16", "width": 4},
            "pixels must have 8 bits, or 16 of which `bfsim record import --bits` says",
        ),
        ({"encoding": ""}, "encoding must be one of"),
        (
            {"encoding": "rgb8"},
            "picture of 8x4 must have rows of 24 bytes or more and 4 of them, not 32 bytes in rows of 8",
        ),
        ({"step": 4}, "not 32 bytes in rows of 4"),
        ({"height": 5}, "rows of 8 bytes or more and 5 of them, not 32 bytes"),
        ({"height": 0}, "picture must have 1 pixel at least and 67,108,864 bytes at most, not be 8x0"),
        ({"width": 4_000_000_000}, "at most, not be 4000000000x4"),
        ({"encoding": "uyvy", "width": 3}, "uyvy must have an even width, not 3"),
    ],
)
def test_a_picture_that_is_none_is_skipped_with_its_partner(
    how: dict[str, object], reason: str, tmp_path: Path
) -> None:
    """The others stay; a bag of nothing else is refused."""
    ros = Ros("ros1")
    bad = {"encoding": "mono8", "width": 8, "height": 4, "step": 8} | how
    rows = grey_rows(50)
    message = ros.image(
        EPOCH_NS + PERIOD_NS, bad["encoding"], rows, bad["width"], height=bad["height"], step=bad["step"]
    )
    messages = grey_pair(ros, range(3))
    messages[2] = (LEFT, IMAGE, EPOCH_NS + PERIOD_NS, message)
    path = ros.write(tmp_path, messages)
    summary = import_recording([path], tmp_path / "out.mcap")
    assert summary.frame_count == 2
    assert [each.name for each in summary.skipped] == [f"{LEFT} 1"]
    assert reason in summary.skipped[0].reason
    alone = tmp_path / "alone"
    alone.mkdir()
    with pytest.raises(RecordingError, match="and no picture is left"):
        imported(ros.write(alone, one_pair(ros, message)))


def test_bytes_that_are_no_jpeg_are_skipped(tmp_path: Path) -> None:
    """Text, another format, and half a picture."""
    ros = Ros("mcap")
    types = ros.store.types["sensor_msgs/msg/CompressedImage"]
    whole = ros.compressed(EPOCH_NS, Image.new("RGB", (16, 16)), "jpeg")
    messages = []
    for k, data in enumerate(
        [whole.data, np.frombuffer(b"hello", np.uint8), whole.data[:200], whole.data[:0]]
    ):
        at = EPOCH_NS + k * PERIOD_NS
        message = types(header=ros.header(at), format="jpeg", data=data)
        messages += [(topic, COMPRESSED, at, message) for topic in (LEFT, RIGHT)]
    summary = import_recording([ros.write(tmp_path, messages)], tmp_path / "out.mcap")
    assert summary.frame_count == 1
    assert len(summary.skipped) == 6


def test_another_size_is_refused_unless_pictures_are_fitted(tmp_path: Path) -> None:
    """As in a folder."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, [*grey_pair(ros, [0]), *grey_pair(ros, [1], size=(16, 8))])
    with pytest.raises(
        RecordingError, match=f"{LEFT} 1: picture must be 8x4 like the first, not 16x8; `--resize`"
    ):
        imported(path)
    assert len(imported(path, resize=(8, 4))) == 2


# ---- topics


@each_kind
def test_a_bag_is_not_overwritten_by_its_recording(kind: str, tmp_path: Path) -> None:
    """`record import drive.mcap drive.mcap --force` put the pictures in the place of all that the bag had."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    file = path if path.is_file() else next(each for each in path.iterdir() if each.suffix != ".yaml")
    before = file.read_bytes()
    with pytest.raises(
        RecordingError, match="must be a file of its own, not one that it is made of|not one of pictures"
    ):
        import_recording([path], file, force=True)
    assert file.read_bytes() == before


@each_kind
def test_a_bag_of_one_camera_asks_for_mono(kind: str, tmp_path: Path) -> None:
    """It asked for two topics of the one that there is."""
    ros = Ros(kind)
    path = ros.write(tmp_path, [each for each in grey_pair(ros, range(2)) if "left" in each[0]])
    with pytest.raises(RecordingError, match=r"\(sensor_msgs/Image, 2\); `--mono` takes the one camera for"):
        imported(path)


@each_kind
def test_a_bag_without_pictures_is_told_so(kind: str, tmp_path: Path) -> None:
    """It was asked for two image topics of none; with `--mono`, too."""
    ros = Ros(kind)
    path = ros.write(tmp_path, [("/imu", "std_msgs/msg/String", EPOCH_NS, ros.imu())])
    for options in ({}, {"mono": True}):
        with pytest.raises(
            RecordingError, match=r"bag must have a topic of sensor_msgs/Image or .*, not /imu \(std"
        ):
            imported(path, **options)


@each_kind
def test_topics_are_listed_where_they_must_be_chosen(kind: str, tmp_path: Path) -> None:
    """With types and counts, pictures first."""
    ros = Ros(kind)
    messages = [*grey_pair(ros, range(2)), ("/imu", "std_msgs/msg/String", EPOCH_NS, ros.imu())]
    messages += [(each[0].replace("stereo", "rear"), *each[1:]) for each in grey_pair(ros, range(2))]
    path = ros.write(tmp_path, messages)
    told = run("import", tmp_path / "a.mcap", path)
    assert told.exit_code != 0
    assert str(told.exception).endswith(
        "`--topics LEFT RIGHT` must name two image topics, of /rear/left/image_raw (sensor_msgs/Image, 2); "
        "/rear/right/image_raw (sensor_msgs/Image, 2); /stereo/left/image_raw (sensor_msgs/Image, 2); "
        "/stereo/right/image_raw (sensor_msgs/Image, 2); /imu (std_msgs/String, 1)"
    )
    assert len(imported(path, topics=("/rear/right/image_raw", "/stereo/left/image_raw"))) == 2


@pytest.mark.parametrize(
    ("left", "right", "is_found"),
    [
        ("/left/image", "/right/image", True),
        ("/cam_left", "/cam_right", True),
        ("/Left/image", "/Right/image", True),
        ("/left/left_cam", "/right/right_cam", True),
        ("/cam0/image", "/cam1/image", False),
        ("/brightleft/image", "/brightright/image", False),
        ("/left/image", "/left/image_2", False),
    ],
)
def test_left_and_right_are_told_by_their_names(
    left: str, right: str, is_found: bool, tmp_path: Path
) -> None:
    """By words of their own, and by nothing else."""
    ros = Ros("ros1")
    names = {LEFT: left, RIGHT: right}
    path = ros.write(tmp_path, [(names[each[0]], *each[1:]) for each in grey_pair(ros, range(2))])
    if is_found:
        assert greys(imported(path)) == [(10, 100), (11, 101)]
    else:
        with pytest.raises(RecordingError, match="`--topics LEFT RIGHT` must name two image topics, of /"):
            imported(path)


@each_kind
def test_topics_that_have_no_pictures_are_refused(kind: str, tmp_path: Path) -> None:
    """One that is not there, one of another type, one that is empty."""
    ros = Ros(kind)
    messages = [*grey_pair(ros, range(2)), ("/imu", "std_msgs/msg/String", EPOCH_NS, ros.imu())]
    path = ros.write(tmp_path, messages, empty=[("/empty", IMAGE)])
    for topic, problem in (
        ("/nothing", "topic /nothing must be in the bag, which has .*/stereo/left/image_raw"),
        (
            "/imu",
            "topic /imu must have sensor_msgs/Image or sensor_msgs/CompressedImage, not std_msgs/String",
        ),
        ("/empty", "topic /empty must have pictures, but has none"),
    ):
        with pytest.raises(RecordingError, match=problem):
            imported(path, topics=(topic, RIGHT))
    with pytest.raises(RecordingError, match="`--topics` must name the one topic twice"):
        imported(path, topics=(LEFT, RIGHT), mono=True)
    with pytest.raises(RecordingError, match="`--topics` must name the camera's topic, twice, of /"):
        imported(path, mono=True)


@pytest.mark.parametrize(
    ("how", "problem"),
    [
        ({"fps": 25}, "`--fps` must not be given, for a bag has time stamps"),
        ({"format": "images"}, "`--topics` and `--slop` must go with a bag of ROS"),
    ],
)
def test_options_that_do_not_go_with_it_are_refused(
    how: dict[str, object], problem: str, tmp_path: Path
) -> None:
    """And the other way round."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    sources = [path] if "fps" in how else [path, path]
    with pytest.raises(RecordingError, match=problem):
        import_recording(sources, tmp_path / "a.mcap", topics=(LEFT, RIGHT), **how)
    with pytest.raises(
        RecordingError, match="sources must be one bag with the topics of both cameras, not 2"
    ):
        import_recording([path, path], tmp_path / "a.mcap")


# ---- what is no bag


def test_a_recording_is_no_bag_and_a_bag_no_recording(tmp_path: Path) -> None:
    """Both are MCAP; each is told what it is by its schemas."""
    own = tmp_path / "own.mcap"
    with RecordingWriter(own, width=8, height=4) as writer:
        writer.add(np.zeros((4, 16), np.uint8), np.zeros((4, 16), np.uint8), 0, 0)
    with pytest.raises(RecordingError, match="it is a recording already, which `bfsim run` plays"):
        import_recording([own], tmp_path / "a.mcap")
    ros = Ros("mcap")
    (bag,) = ros.write(tmp_path, grey_pair(ros, range(2))).glob("*.mcap")
    with pytest.raises(RecordingError, match="`bfsim record import` makes a recording of a bag of ROS"):
        RecordingReader(bag)


@each_kind
def test_a_cut_bag_is_refused(kind: str, tmp_path: Path) -> None:
    """Wherever it was cut, with its name; nothing is left of the recording."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(4)))
    file = path if path.is_file() else next(path.glob("*.[md]*[p3]"))
    whole = file.read_bytes()
    for part in (0, 7, 100, len(whole) // 3, len(whole) // 2, len(whole) - 20):
        file.write_bytes(whole[:part])
        with pytest.raises(RecordingError, match="drive"):
            import_recording([path], tmp_path / "out.mcap")
    assert not (tmp_path / "out.mcap").exists()


@pytest.mark.exhaustive
@each_kind
def test_a_damaged_bag_is_refused_or_read(kind: str, tmp_path: Path) -> None:
    """Some bytes are others: no traceback, and no picture of another size."""
    ros = Ros(kind)
    path = ros.write(tmp_path, grey_pair(ros, range(4)))
    file = path if path.is_file() else next(path.glob("*.[md]*[p3]"))
    whole = file.read_bytes()
    refused = 0
    random = Random(15)
    for _ in range(60):
        octets = bytearray(whole)
        for _ in range(random.choice((1, 2, 8))):
            octets[random.randrange(len(octets))] = random.choice((0, 1, 127, 255, random.randrange(256)))
        file.write_bytes(octets)
        try:
            summary = import_recording([path], tmp_path / "out.mcap", force=True)
        except RecordingError as error:
            refused += 1
            assert len(str(error)) < 1000
        else:
            assert (summary.width, summary.height) == (8, 4)
    assert refused


def test_other_files_are_no_bags(tmp_path: Path) -> None:
    """By name, and by what is in them."""
    for name, octets in (
        ("a.bag", b""),
        ("b.bag", b"#ROSBAG V1.2\n"),
        ("c.db3", b"SQLite format 3\0"),
        ("d.mcap", b"mcap"),
    ):
        (tmp_path / name).write_bytes(octets)
        with pytest.raises(RecordingError, match=f"{name}: bag must be whole and of ROS"):
            import_recording([tmp_path / name], tmp_path / "out.mcap")
    with pytest.raises(RecordingError, match="none.bag: bag must be a file or a folder, but is not there"):
        import_recording([tmp_path / "none.bag"], tmp_path / "out.mcap")
    (tmp_path / "metadata.yaml").write_text("!!python/object/apply:os.system ['touch pwned']\n")
    with pytest.raises(RecordingError, match="bag must be whole and of ROS"):
        import_recording([tmp_path], tmp_path.parent / "out.mcap")
    assert not Path("pwned").exists()


def test_nothing_is_made_of_the_definitions_in_a_bag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """rosbags would make code of them; an Image of one's own is refused."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    octets = path.read_bytes()
    assert len(imported(path)) == 2

    def refuse(*_: object) -> None:
        raise AssertionError("a definition was compiled")

    monkeypatch.setattr("rosbags.typesys.store.Typestore.register", refuse)
    assert len(imported(path)) == 2
    path.write_bytes(octets.replace(b"060021388200f6f0f447d0fcd9c64743", b"1" * 32))
    with pytest.raises(
        RecordingError, match="must have sensor_msgs/msg/Image as ROS defines it, not another"
    ):
        imported(path)


def test_without_rosbags_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is optional."""
    ros = Ros("ros1")
    path = ros.write(tmp_path, grey_pair(ros, range(2)))
    monkeypatch.setitem(sys.modules, "rosbags", None)
    with pytest.raises(RecordingError, match=r'pip install "bfsim\[ros\]"'):
        imported(path)


@pytest.mark.exhaustive
def test_memory_does_not_grow_with_the_bag(tmp_path: Path) -> None:
    """Four times as many pictures, the same peak."""
    ros = Ros("ros1")
    peaks = []
    for count in (10, 40):
        folder = tmp_path / str(count)
        folder.mkdir()
        path = ros.write(folder, grey_pair(ros, range(count), size=(320, 240)))
        imported(path.parent / path.name, mono=False)
        tracemalloc.start()
        import_recording([path], folder / "again.mcap")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]
