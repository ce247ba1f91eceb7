"""Which pictures of two cameras were taken at once: by what their names have in common, or by their order."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from bfsim.errors import RecordingError
from bfsim.recording.importing.sources import Skipped

SIDES = ("left", "right")

_SIDE = re.compile(r"(?i:left|right|(?<![a-z])[lr](?![a-z]))|(?<=[a-z])[LR](?![A-Za-z])")
"""What of a name says which camera it is: left, right, l and r by themselves, or L and R behind a word, as in imageL7."""

Pair = tuple[Path, Path]


def side_of(name: str) -> str | None:
    """Return left or right if a name says that it is that camera's, and only that."""
    found = {each[0].lower() for each in _SIDE.findall(name)}
    return next((side for side in SIDES if found == {side[0]}), None)


def pairs_of(lefts: Sequence[Path], rights: Sequence[Path], what: str) -> tuple[list[Pair], list[Skipped]]:
    """Return the pictures that belong together, and those of one camera alone.

    Names without what says the camera are compared: left_03 goes with right_03. Where no two are alike, the pictures
    go together by their order, if there are as many. Raises RecordingError that begins with `what` where that would be a
    guess.
    """
    of_left, of_right = ({_key(path): path for path in paths} for paths in (lefts, rights))
    common = [key for key in of_left if key in of_right]
    if common and len(of_left) == len(lefts) and len(of_right) == len(rights):
        alone = [path for keys in (of_left, of_right) for key, path in keys.items() if key not in common]
        skipped = [Skipped(_name(path), "has no picture of the other camera") for path in alone]
        return [(of_left[key], of_right[key]) for key in common], skipped
    if len(lefts) != len(rights):
        raise RecordingError(
            f"{what} must have names that tell the pairs, such as left_01.png and right_01.png, or be as many of either "
            f"camera, to be paired by their order, not {len(lefts)} and {len(rights)}"
        )
    return list(zip(lefts, rights, strict=True)), []


def _key(path: Path) -> str:
    return _SIDE.sub("", path.stem)


def _name(path: Path) -> str:
    """Return a picture as a list has it: with its folder, since names of both cameras may be the same."""
    return f"{path.parent.name}/{path.name}"
