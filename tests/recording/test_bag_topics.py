"""`record import` of bags: which topics are the cameras', and which options go with them."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.errors import RecordingError
from bfsim.recording.importing.importer import import_recording
from tests.recording.bag_imports import IMAGE, each_kind, greys, imported, run
from tests.recording.bags import (
    EPOCH_NS,
    LEFT,
    RIGHT,
    Ros,
    grey_pair,
)


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
    with pytest.raises(RecordingError, match=f"must name those of two cameras, not {LEFT} twice; `--mono`"):
        imported(path, topics=(LEFT, LEFT))
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
    sources = [path] if "fps" in how else [path, tmp_path]
    with pytest.raises(RecordingError, match=problem):
        import_recording(sources, tmp_path / "a.mcap", topics=(LEFT, RIGHT), **how)
    with pytest.raises(
        RecordingError, match="sources must be one bag with the topics of both cameras, not 2"
    ):
        import_recording([path, path], tmp_path / "a.mcap")
