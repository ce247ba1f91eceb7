"""Pair the pictures of two cameras by their names, or by their order."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.importing.sources import Skipped

SIDES = ("left", "right")

_SIDE = re.compile(r"(?i:left|right|(?<![a-z])[lr](?![a-z]))|(?<=[a-z])[LR](?![A-Za-z])")
"""The part of a name that tells the camera: left, right, l and r alone, or L and R after a word, as in imageL7."""

Pair = tuple[Path, Path]


def side_of(name: str) -> str | None:
    """Return left or right if a name says that it is from that camera, and only that."""
    found = {each[0].lower() for each in _SIDE.findall(name)}
    return next((side for side in SIDES if found == {side[0]}), None)


def pairs_of(lefts: Sequence[Path], rights: Sequence[Path], what: str) -> tuple[list[Pair], list[Skipped]]:
    """Return the pictures that belong together, and those of one camera alone.

    Names are compared without the part that tells the camera: left_03 goes with right_03. If no two are alike, pictures
    are paired in order, if there are equally many. Raises RecordingError, beginning with `what`, if a pairing would be
    a guess, also if two pictures could go with a third one.
    """
    of_left, of_right = ({_key(path): path for path in paths} for paths in (lefts, rights))
    common = of_left.keys() & of_right.keys()
    if common:
        _require_one_each(lefts, of_left, of_right, what)
        _require_one_each(rights, of_right, of_left, what)
        alone = [path for path in (*lefts, *rights) if _key(path) not in common]
        skipped = [Skipped(_name(path), "has no picture of the other camera") for path in alone]
        return [(path, of_right[key]) for key, path in of_left.items() if key in common], skipped
    if len(lefts) != len(rights):
        raise RecordingError(
            f"{what} must have names that tell the pairs, such as left_01.png and right_01.png, or be as many of either "
            f"camera, to be paired by their order, not {len(lefts)} and {len(rights)}"
        )
    return list(zip(lefts, rights, strict=True)), []


def _require_one_each(
    paths: Sequence[Path], last: Mapping[str, Path], others: Mapping[str, Path], what: str
) -> None:
    """Raise RecordingError if two pictures of a camera match one of the `others`; `last` has the last of each name."""
    for path in paths:
        key = _key(path)
        if last[key] != path and key in others:
            raise RecordingError(
                f"{what} must have names that tell the pairs, but {_name(path)} and {_name(last[key])} "
                f"both go with {_name(others[key])}"
            )


def _key(path: Path) -> str:
    return _SIDE.sub("", path.stem)


def _name(path: Path) -> str:
    """Return a picture's name for lists: with its folder, since both cameras may use the same names."""
    return f"{path.parent.name}/{path.name}"
