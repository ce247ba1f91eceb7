"""What becomes of the objects that the cameras see, from both of them and from frame to frame; shares no code with the kernels.

Records are dictionaries by the names of their words.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction

from tests.firmware.objects.place_references import BASELINE, FARTHEST, FOCAL, Record, rounded

# Verification


def disparity_depth(geometry: Sequence[int], disparity: int) -> int:
    """The depth in mm of a disparity in 1/16 px, 0 for none."""
    if disparity <= 0:
        return 0
    depth = (geometry[FOCAL] * geometry[BASELINE] // disparity + 500) // 1000
    return depth if depth <= FARTHEST else 0


def unlikeness(one: Record, other: Record, row_range: int, disparity_max: int) -> int | None:
    """How unlike two objects are; None if they cannot be the same. One that is less high may lack its upper end or its lower one."""
    rows = max(abs(one["image_y"] - other["image_y"]) - abs(one["height"] - other["height"]) // 2, 0)
    disparity = one["image_x"] - other["image_x"]
    if one["model"] != other["model"] or rows > row_range or not -row_range <= disparity <= disparity_max:
        return None
    return rows + abs(one["width"] - other["width"])


def verified(
    left: Sequence[Record],
    right: Sequence[Record],
    geometry: Sequence[int],
    ranges: Sequence[int],
    weights: Sequence[int],
    refined: bool,
    width: int,
) -> tuple[list[Record], list[Record]]:
    """The objects of the left camera, made better by the right one's; and what the right one has beside, free ones too.

    `ranges`: of rows, the largest of disparities, and between disparities; `weights`: of the second camera and of the size;
    `width`: of the pictures.
    """
    baseline = (geometry[BASELINE] + 500) // 1000
    others = [each | ({"x": each["x"] + baseline} if each["measures"] else {}) for each in right]
    result = []
    for one in left:
        likes = [
            (unlike, number)
            for number, other in enumerate(others)
            if one["model"] and (unlike := unlikeness(one, other, *ranges[:2])) is not None
        ]
        if not likes:
            result.append(one)
            continue
        other = others[min(likes)[1]]
        result.append(_pair(one, other, geometry, ranges[2], weights, refined, width))
        others[min(likes)[1]] = other | {"model": 0}
    return result, others


def _pair(
    one: Record,
    other: Record,
    geometry: Sequence[int],
    off: int,
    weights: Sequence[int],
    refined: bool,
    width: int,
) -> Record:
    both = dict(one)
    nearer, farther = sorted((one["z"], other["z"]))
    agree = not (refined and one["measures"] == other["measures"] == 2 and 8 * (farther - nearer) > nearer)
    if not agree:
        better = _to_be_believed(one, other, width)
        both |= {name: better[name] for name in ("x", "y", "z", "extent")}
    elif one["measures"] and other["measures"]:
        both |= {name: (one[name] + other[name] + 1) // 2 for name in ("x", "y", "z", "extent")}
    elif other["measures"]:
        both |= {name: other[name] for name in ("x", "y", "z", "extent")}
    both["measures"] = one["measures"] | other["measures"]
    both["cameras"] = 3
    tests = one["tests"] | other["tests"]
    accuracy = max(one["accuracy"], other["accuracy"])
    if refined and one["tests"] & other["tests"] & 16 and both["measures"] & 1:
        agree = _by_disparity(both, one["image_x"] - other["image_x"], geometry, off)
    if agree:
        return both | {"accuracy": min(accuracy + weights[0], 255), "tests": tests | 32}
    return both | {"accuracy": max(accuracy - weights[1], 0), "tests": tests & ~16}


def _to_be_believed(one: Record, other: Record, width: int) -> Record:
    """Of two that disagree the one with more tests; if that says nothing, or both are cut at a side, the nearer one; or else the first."""
    cut = [
        each["image_x"] - each["width"] // 2 < 16 or each["image_x"] + each["width"] // 2 > 16 * width - 32
        for each in (one, other)
    ]
    if one["accuracy"] != other["accuracy"] and not all(cut):
        return max(one, other, key=lambda each: each["accuracy"])
    return min(one, other, key=lambda each: each["z"])


def _by_disparity(both: Record, disparity: int, geometry: Sequence[int], off: int) -> bool:
    """Place an object by its disparity too, or alone if that is more than `off` from what its depth makes; whether it is not."""
    before, depth = both["z"], disparity_depth(geometry, disparity)
    if before <= 0:
        return False
    agree = abs((geometry[FOCAL] * geometry[BASELINE] // before + 500) // 1000 - disparity) <= off
    if not depth:
        return agree
    better, measures, extent = depth, 4, disparity
    if agree:
        squares = [max(min((each + 8) // 16, 128), 1) ** 2 for each in (both["extent"], disparity)]
        better = rounded(Fraction(before * squares[0] + depth * squares[1], sum(squares)))
        measures, extent = both["measures"] | 4, both["extent"]
    moved = {name: (both[name] * better + before // 2) // before for name in ("x", "y")}
    both |= moved | {"z": better, "measures": measures, "extent": extent}
    return agree


# History


def remembered(
    history: Sequence[Record], seen: Sequence[Record], goals: Collection[int], age_max: int, apart_max: int
) -> tuple[list[Record], int]:
    """The history after a frame with the objects seen, free records too, and how many found no room.

    `goals`: the numbers of the models that there is one thing of.
    """
    records = [
        each | {"age": each["age"] + 1, "model": each["model"] if each["age"] < age_max else 0}
        if each["model"]
        else each
        for each in history
    ]
    lost = 0
    for one in seen:
        if not one["model"]:
            continue
        only = [number for number, each in enumerate(records) if each["model"] == one["model"]]
        if one["model"] in goals and only:
            was = records[only[0]]
            records[only[0]] = max(was, one, key=lambda each: each["accuracy"]) if was["age"] == 0 else one
            continue
        old = [number for number, each in enumerate(records) if each["model"] and each["age"] > 0]
        near = [
            (gap(one, records[number]), number) for number in old if records[number]["model"] == one["model"]
        ]
        free = [number for number, each in enumerate(records) if not each["model"]]
        oldest = [(-records[number]["age"], number) for number in old]
        if near and min(near)[0] <= apart_max:
            records[min(near)[1]] = one
        elif free:
            records[free[0]] = one
        elif oldest:
            records[min(oldest)[1]] = one
        else:
            lost += 1
    return records, lost


def gap(one: Record, other: Record) -> int:
    """How far apart two objects are seen, in 1/256 of the focal length."""
    tangents = [[256 * each[name] // max(each["z"], 1) for name in ("x", "y")] for each in (one, other)]
    return sum(abs(a - b) for a, b in zip(*tangents, strict=True))
