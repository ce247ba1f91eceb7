"""The topics of a bag of ROS that hold the cameras' pictures."""

from __future__ import annotations

import re

from bfsim.errors import RecordingError, cut
from bfsim.recording.ros.bag_file import Topic
from bfsim.recording.ros.ros_images import IMAGE_TYPES

_SIDES = re.compile(r"(?<![a-z])(left|right)(?![a-z])", re.IGNORECASE)
_OTHER_SIDE = {"left": "right", "right": "left"}


def single_topic(name: str, found: dict[str, Topic], topics: tuple[str, str] | None) -> tuple[Topic, ...]:
    """Return the only topic of pictures, which `topics`, if given, name twice. Raises RecordingError."""
    _require_images(name, found)
    if topics is not None:
        if topics[0] != topics[1]:
            raise RecordingError(
                f"{name}: `--topics` must name the one topic twice, not {' and '.join(topics)}"
            )
        return (_picture_topic(name, found, topics[0]),)
    images = [each for each in found.values() if each.kind in IMAGE_TYPES]
    if len(images) != 1:
        raise RecordingError(f"{name}: `--topics` must name the camera's topic, twice, of {_listed(found)}")
    return (_picture_topic(name, found, images[0].name),)


def pair_of_topics(name: str, found: dict[str, Topic], topics: tuple[str, str] | None) -> tuple[Topic, ...]:
    """Return the left and right camera's topics: `topics`, or the only two with names for left and right.

    Raises RecordingError if there are none, or several.
    """
    _require_images(name, found)
    if topics is None:
        lefts = [
            each for each in found.values() if each.kind in IMAGE_TYPES and _other_side(each.name, "left")
        ]
        pairs = [(each.name, other) for each in lefts if (other := _other_side(each.name, "left")) in found]
        pairs = [each for each in pairs if found[each[1]].kind in IMAGE_TYPES]
        if len(pairs) != 1:
            of_one = "; `--mono` takes the one camera for both sides" if _count_of_images(found) == 1 else ""
            raise RecordingError(
                f"{name}: `--topics LEFT RIGHT` must name two image topics, of {_listed(found)}{of_one}"
            )
        topics = pairs[0]
    if topics[0] == topics[1]:
        raise RecordingError(
            f"{name}: `--topics` must name those of two cameras, not {cut(topics[0])} twice; `--mono` takes one camera for both sides"
        )
    return tuple(_picture_topic(name, found, each) for each in topics)


def _require_images(name: str, found: dict[str, Topic]) -> None:
    if not _count_of_images(found):
        raise RecordingError(
            f"{name}: bag must have a topic of sensor_msgs/Image or sensor_msgs/CompressedImage, not {_listed(found)}"
        )


def _count_of_images(found: dict[str, Topic]) -> int:
    return sum(each.kind in IMAGE_TYPES for each in found.values())


def _other_side(topic: str, side: str) -> str:
    """Return the name of the other camera's topic; "" if the name does not say that it is from `side`."""
    sides = {each.lower() for each in _SIDES.findall(topic)}
    return _SIDES.sub(lambda found: _like(found[0], _OTHER_SIDE[side]), topic) if sides == {side} else ""


def _like(model: str, word: str) -> str:
    return word.upper() if model.isupper() else word.capitalize() if model[0].isupper() else word


def _picture_topic(name: str, found: dict[str, Topic], wanted: str) -> Topic:
    topic = found.get(wanted)
    if topic is None:
        raise RecordingError(f"{name}: topic {cut(wanted)} must be in the bag, which has {_listed(found)}")
    if topic.kind not in IMAGE_TYPES:
        raise RecordingError(
            f"{name}: topic {topic.name} must have sensor_msgs/Image or sensor_msgs/CompressedImage, not "
            f"{topic.kind.replace('/msg/', '/')}"
        )
    if not topic.count:
        raise RecordingError(f"{name}: topic {topic.name} must have pictures, but has none")
    return topic


def _listed(found: dict[str, Topic]) -> str:
    images = [each for each in found.values() if each.kind in IMAGE_TYPES]
    others = [each for each in found.values() if each.kind not in IMAGE_TYPES]
    return "; ".join(cut(str(each)) for each in (*images, *others)) or "none"
