"""Pictures from bags of ROS 1 and ROS 2: which ones belong together, and their camera_info."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from bfsim.errors import RecordingError
from bfsim.recording.cameras.camera_info import CAMERA_INFO, CameraInfo
from bfsim.recording.importing.sources import PictureSource, Skipped
from bfsim.recording.importing.time_pairs import Times, nearest_pairs, period_ns, rising
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.ros.bag_file import BagFile, Topic
from bfsim.recording.ros.bag_topics import pair_of_topics, single_topic
from bfsim.recording.ros.ros_images import IMAGE, IMAGE_TYPES, order_note, planes_of

DEFAULT_PERIOD_NS = 1e9 / 30
"""For bags with a single picture: the rate of the sensors that bfsim knows."""
_FPS_PARTS = 1_000
TRANSPORT = "compressed"
"""The name of a compressed topic below that of the picture, as in image_transport; some drivers leave it out."""


@dataclass(frozen=True, slots=True)
class BagPictures:
    """The pictures of one or two cameras, each camera's camera_info or None, and notes on decisions for the user."""

    sources: tuple[PictureSource, ...]
    cameras: tuple[CameraInfo | None, ...]
    notes: tuple[str, ...]


def open_bag(
    name: str,
    topics: tuple[str, str] | None = None,
    slop_s: float | None = None,
    *,
    single: bool,
    mixed: bool,
    bits: int | None = None,
) -> BagPictures:
    """Open a .bag, .db3 or .mcap file, or the folder of a ROS 2 bag.

    Pictures of `topics`, left and right, are paired if they are each other's nearest within `slop_s`, or half a frame
    period; the others are skipped. Without `topics` there must be exactly one pair of image topics whose names differ
    by left and right. `single`: there must be one image topic, or `topics` name it twice. Without `mixed`, all pictures
    of a topic must have one size. `bits`: how many the cameras use of 16-bit pixels. Raises RecordingError.
    """
    bag = BagFile(Path(name))
    found = {each.name: each for each in bag.topics()}
    chosen = single_topic(name, found, topics) if single else pair_of_topics(name, found, topics)
    times, clock = _times(bag, chosen)
    usable = [rising(each) for each in times]
    rising_ns = [each[numbers] for each, numbers in zip(times, usable, strict=True)]
    slop_ns = slop_s * 1e9 if slop_s is not None else (period_ns(rising_ns[0]) or DEFAULT_PERIOD_NS) / 2
    pairs = nearest_pairs(rising_ns[0], rising_ns[-1], slop_ns)
    if not pairs[0].size:
        raise RecordingError(f"{name}: {_apart(chosen, rising_ns, slop_ns)}")
    start_ns = min(int(each[numbers[0]]) for each, numbers in zip(rising_ns, pairs, strict=False))
    rate = period_ns(rising_ns[0][pairs[0]])
    sources = tuple(
        _source(
            bag,
            topic,
            own[numbers],
            tuple(int(each) - start_ns for each in own_ns[numbers]),
            (
                *_late(topic, own, all_ns),
                *_alone(topic, chosen[-1 - side], own, numbers, slop_ns),
            ),
            Fraction(1e9 / rate).limit_denominator(_FPS_PARTS) if rate else None,
            mixed=mixed,
            bits=bits,
        )
        for side, (topic, own, own_ns, all_ns, numbers) in enumerate(
            zip(chosen, usable, rising_ns, times, pairs, strict=False)
        )
    )
    infos = [_camera_info(bag, topic, found) for topic in chosen]
    orders = (order_note(each) for topic in chosen for each in _encodings(bag, topic))
    notes = (clock, *orders, *(note for _, note in infos))
    return BagPictures(sources, tuple(info for info, _ in infos), tuple(dict.fromkeys(filter(None, notes))))


# ---- when


def _times(bag: BagFile, topics: Sequence[Topic]) -> tuple[list[Times], str]:
    """Return when the pictures of each topic were taken, and a note about it."""
    stamps: list[Times] = []
    logged: list[Times] = []
    for topic in topics:
        pairs = [(bag.stamp_ns(raw), log_ns) for log_ns, raw in bag.messages(topic.name)]
        if len(pairs) != topic.count:
            raise RecordingError(
                f"{bag.path}: topic {topic.name} must have the {topic.count:,} pictures that the bag's index says, not {len(pairs):,}"
            )
        own = np.array(pairs, np.int64).reshape(-1, 2)
        stamps.append(own[:, 0])
        logged.append(own[:, 1])
    if all(each.any() for each in stamps):
        return stamps, ""
    return logged, "The pictures have no time stamps: they are paired by the times at which the bag got them."


def _late(topic: Topic, usable: Any, times_ns: Times) -> Iterator[Skipped]:
    for number in sorted({*range(times_ns.size)} - {*usable}):
        yield Skipped(f"{topic.name} {number}", "its time stamp is not later than those before")


def _alone(topic: Topic, other: Topic, usable: Any, paired: Any, slop_ns: float) -> Iterator[Skipped]:
    for number in np.delete(usable, paired):
        yield Skipped(f"{topic.name} {number}", f"no picture of {other.name} within {slop_ns / 1e6:.4g} ms")


def _apart(topics: Sequence[Topic], times_ns: Sequence[Times], slop_ns: float) -> str:
    near = min(int(np.abs(times_ns[-1] - each).min()) for each in times_ns[0])
    return (
        f"pictures of {topics[0].name} and {topics[-1].name} must be within {slop_ns / 1e6:.4g} ms of each other, but the "
        f"nearest two are {near / 1e6:.4g} ms apart; `--slop` sets the limit"
    )


# ---- pictures


def _source(
    bag: BagFile,
    topic: Topic,
    numbers: Any,
    times_ns: tuple[int, ...],
    skipped: tuple[Skipped, ...],
    fps: Fraction | None,
    *,
    mixed: bool,
    bits: int | None,
) -> PictureSource:
    wanted = {int(each) for each in numbers}

    def pictures(model: tuple[int, int] | None = None) -> Iterator[YuvPlanes | Skipped]:
        for number, (_, raw) in enumerate(bag.messages(topic.name)):
            if number not in wanted:
                continue
            try:
                picture = planes_of(bag.decode(raw, topic.kind), topic.kind, bits)
            except RecordingError as error:
                yield Skipped(f"{topic.name} {number}", str(error))
                continue
            if model and picture.size != model:
                raise RecordingError(
                    f"{bag.path}: {topic.name} {number}: picture must be {model[0]}x{model[1]} like the first, not "
                    f"{picture.size[0]}x{picture.size[1]}; `--resize` or `--crop` brings all to one size"
                )
            yield picture

    first, reason = None, ""
    for each in pictures():
        if isinstance(each, YuvPlanes):
            first = each.size
            break
        reason = reason or each.reason
    if first is None:
        raise RecordingError(f"{bag.path}: {topic.name}: {reason}, and no picture is left")
    return PictureSource(
        name=f"{bag.path}: {topic.name}",
        size=first,
        count=len(wanted),
        fps=fps,
        pictures=lambda: pictures(None if mixed else first),
        skipped=skipped,
        times_ns=times_ns,
    )


def _encodings(bag: BagFile, topic: Topic) -> Iterator[str]:
    """Yield the encoding of a topic's first picture, if its pictures have encodings."""
    if topic.kind == IMAGE:
        with suppress(RecordingError):
            yield from (bag.decode(raw, IMAGE).encoding for _, raw in islice(bag.messages(topic.name), 1))


def _info_of(base: list[str]) -> str:
    """Return the topic of the camera_info in a name space."""
    return "/".join([*base, "camera_info"])


def _camera_info(bag: BagFile, topic: Topic, found: dict[str, Topic]) -> tuple[CameraInfo | None, str]:
    """Return the first camera_info beside a topic, and a note if there are different ones, or none."""
    *beside, own = parts = topic.name.split("/")
    above = (
        beside[:-1] if topic.kind != IMAGE_TYPES[0] and len(beside) > 1 else beside
    )  # for image_raw/compressed
    bases = [above, beside] if own == TRANSPORT else [beside, above]
    base = next((each for each in bases if _info_of(each) in found), bases[0])
    name = _info_of(base)
    if name not in found or found[name].kind != CAMERA_INFO or not found[name].count:
        return None, f"There is no {name}: neither geometry nor rectification is known."
    is_rectified = parts[len(base)].startswith("image_rect")
    said = [
        CameraInfo.of(bag.decode(raw, CAMERA_INFO), name, is_rectified=is_rectified)
        for _, raw in bag.messages(name)
    ]
    changes = len(set(map(repr, said))) > 1  # as they are written, for NaN is not itself
    return said[
        0
    ], f"{name} changes in the bag: what it says first is taken for all pictures." if changes else ""
