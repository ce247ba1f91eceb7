"""What a run would be: all inputs but the frames are read and checked, and nothing runs."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import Any

from bfsim.run import simulate
from bfsim.running.digested_frames import recording_digest
from bfsim.trace import Identity


class _KnownError(Exception):
    """Ends a run before its first frame, once everything about it is known."""


def planned(**what: Any) -> tuple[Identity, int]:
    """Return the identity of what `simulate` would run, without the recording's digest, and its number of frames.

    Nothing runs. Raises what `simulate` would raise before the first frame.
    """
    known = list[tuple[Identity, int]]()

    def stop(identity: Identity, frames: int) -> None:
        known.append((identity, frames))
        raise _KnownError

    with suppress(_KnownError):
        simulate(before=stop, **what)
    return known[0]


def identified(**what: Any) -> tuple[Identity, int]:
    """Return the same as `planned`, with the digest of the recording, for which all frames are read."""
    identity, frames = planned(**what)
    return replace(identity, recording_digest=recording_digest(what.get("recording"), frames)), frames
