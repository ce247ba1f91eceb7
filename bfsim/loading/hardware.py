"""Find boards and compilers by name: shipped ones, FILE.py:NAME, or PACKAGE:NAME; check that they are possible."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Generic

from bfsim.chip.boards import BOARDS, board_named
from bfsim.chip.checks import require_sound
from bfsim.chip.settings import with_settings
from bfsim.chip.spec import BoardSpec
from bfsim.errors import ConfigError, FirmwareError, cut
from bfsim.fields import leaves, require_types
from bfsim.kernel import CompilerProfile, profile_named
from bfsim.kernel.profile import PROFILES
from bfsim.loading.importing import OwnModules
from bfsim.loading.named import Loaded, NamedKind, Wanted, load_named
from bfsim.process.once import once

BOARD = NamedKind("board", "--board", BoardSpec, "bfsim.chip.spec", tuple(BOARDS))
PROFILE = NamedKind("compiler profile", "--profile", CompilerProfile, "bfsim.kernel", tuple(PROFILES))

NAMES = {"name", "title"}
"""Fields that name a thing without describing it."""
MOST_CCLK = 1_000_000
"""The most cycles that a routine of a compiler's library may take. [assumed] far beyond any."""


@dataclass(frozen=True, slots=True)
class Found(Generic[Wanted]):
    """A board or a compiler profile, named as in the identity of a run.

    `files` are those that it was imported from, none for a shipped one; `digest` covers all its values and these files.
    `numbers` are the values that differ from the most similar shipped one, which is named first; none for a shipped
    one.
    """

    value: Wanted
    files: tuple[str, ...]
    digest: str
    numbers: tuple[str, ...]


@once
def find_board(
    board: str | BoardSpec, settings: Mapping[str, object] = MappingProxyType({})
) -> Found[BoardSpec]:
    """Return a board that can be built, with other numbers by their paths, as in `with_settings`.

    Its name is NAME or MODULE:NAME, with --set PATH=VALUE for each setting. Raises ConfigError, with the field, for an
    impossible board, and for a BoardSpec that has the name of a shipped one but other numbers.
    """
    own = None
    if isinstance(board, BoardSpec):
        if BOARDS.get(board.name, board) != board:
            raise ConfigError(
                f"a board must have a name of its own, not {board.name}, which is a shipped one's"
            )
        spec = board
    elif board in BOARDS:
        spec = board_named(board)
    else:
        found = _load(board, BOARD, BOARDS)
        spec, own = _named(found), found.own
    try:
        require_sound(spec)
    except ConfigError as error:
        raise ConfigError(f"--board {spec.name}: {error}") from error
    spec, names = with_settings(spec, settings)
    return _found(replace(spec, name=" --set ".join([spec.name, *names])), own, BOARDS)


@once
def find_profile(name: str) -> Found[CompilerProfile]:
    """Return a compiler profile, named NAME or MODULE:NAME. Raises ConfigError, with the field, for an impossible one."""
    if name in PROFILES:
        return _found(profile_named(name), None, PROFILES)
    found = _load(name, PROFILE, PROFILES)
    profile = _named(found)
    require_types(profile, f"--profile {profile.name}: profile")
    for leaf in leaves(profile):
        if isinstance(leaf.value, int) and not 0 <= leaf.value <= MOST_CCLK:
            raise ConfigError(
                f"--profile {profile.name}: profile.{leaf.path} must be 0 to {MOST_CCLK:,} cycles, not {leaf.value:,}"
            )
    return _found(profile, found.own, PROFILES)


def _load(name: str, kind: NamedKind[Wanted], shipped: Mapping[str, Wanted]) -> Loaded[Wanted]:
    try:
        return load_named(name, kind, shipped.values())
    except FirmwareError as error:
        raise ConfigError(str(error)) from error


def _named(found: Loaded[Wanted]) -> Wanted:
    """Return what was found, renamed after its place in the user's files: no other has that name."""
    return replace(found.value, name=found.name)  # type: ignore[type-var]


def _found(value: Wanted, own: OwnModules | None, shipped: Mapping[str, Wanted]) -> Found[Wanted]:
    """Return a board or compiler with its files, its digest and its numbers."""
    of_files = own.digest if own else ""
    digest = hashlib.sha256((repr(value) + of_files).encode()).hexdigest()
    return Found(value, own.files if own else (), digest, tuple(_numbers(value, shipped)))


def _numbers(value: Wanted, shipped: Mapping[str, Wanted]) -> Iterator[str]:
    """Yield the shipped one that a board or compiler is most like, and the values that differ from it."""
    if value in shipped.values():
        return
    mine = _leaves(value).items()
    others = {name: mine - _leaves(each).items() for name, each in shipped.items()}
    nearest = min(others, key=lambda name: len(others[name]))
    yield f"like {nearest}"
    yield from (f"{path} = {text}" for path, text in mine if (path, text) in others[nearest])


def _leaves(value: object) -> dict[str, str]:
    return {each.path: cut(str(each.value)) for each in leaves(value) if each.path not in NAMES}
