"""The frames of a recording as they are read, and the digest of all up to each."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bfsim import shipped
from bfsim.errors import WorkError
from bfsim.process.reading_ahead import read_ahead
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.running.identifying import name_of


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownFrames:
    """Frames that have been read: `digests` of the recording up to each, `times_ns` of its left and right picture.

    `stored_digest` covers the file up to byte `stored_end`, as far as it was read.
    """

    digests: tuple[str, ...]
    times_ns: tuple[tuple[int, int], ...]
    stored_end: int
    stored_digest: str

    def __post_init__(self) -> None:
        if len(self.digests) != len(self.times_ns):
            raise ValueError("each frame must have a digest and its times")


class DigestedFrames:
    """The frames of a recording as they are read, and the digest of those read so far."""

    def __init__(self, reader: RecordingReader, total: int) -> None:
        self.name = name_of(Path(reader.path))
        self._reader = reader
        self.total = total
        self.digests: list[str] = []
        """Digests of the recording up to each frame that was read."""
        self._expected: KnownFrames | None = None
        self._times_ns: list[tuple[int, int]] = []

    def __iter__(self) -> Iterator[StereoFrame]:
        expected = self._expected
        if expected and self._reader.stored_digest(expected.stored_end) == expected.stored_digest:
            frames = self._unseen(expected)
        else:
            frames = read_ahead(self._with_digests())
        for frame, digest in frames:
            self.digests.append(digest)
            if expected and expected.digests[frame.index] != digest:
                raise WorkError(
                    f"{self.name} must be as it was when its run was recorded, but frame {frame.index} differs: record it again"
                )
            self._times_ns.append((frame.left_ns, frame.right_ns))
            yield frame

    def _with_digests(self) -> Iterator[tuple[StereoFrame, str]]:
        """Yield frames with the digest of the recording up to each."""
        digest = hashlib.sha256()
        for frame in self._reader.frames(self.total):
            digest.update(f"{frame.left.shape} {frame.left_ns} {frame.right_ns}\n".encode())
            digest.update(frame.left.tobytes())
            digest.update(frame.right.tobytes())
            yield frame, digest.hexdigest()

    def _unseen(self, known: KnownFrames) -> Iterator[tuple[StereoFrame, str]]:
        """Yield black frames for frames that are stored as before, since nobody looks at their pictures again."""
        black = np.zeros((self._reader.height, 2 * self._reader.width), np.uint8)
        for index, (digest, (left_ns, right_ns)) in enumerate(
            zip(known.digests, known.times_ns, strict=True)
        ):
            yield StereoFrame(index, black, black, left_ns, right_ns, None), digest

    @property
    def known(self) -> KnownFrames:
        """What is known of the frames read so far."""
        end = self._reader.read_end
        return KnownFrames(
            digests=tuple(self.digests),
            times_ns=tuple(self._times_ns),
            stored_end=end,
            stored_digest=self._reader.stored_digest(end),
        )

    def expect(self, known: KnownFrames) -> None:
        """Compare each frame read from now on with what was read before. Raises WorkError if one differs.

        If the file is the same, byte by byte, as far as it was read, the pictures are not unpacked, and are black.
        """
        self._expected = known

    def times_ns(self, index: int) -> dict[str, int]:
        """Return when the pictures of a frame were taken, by camera."""
        return dict(zip(("left", "right"), self._times_ns[index], strict=True))

    @property
    def digest(self) -> str:
        """Digest of the pixels and time stamps read so far."""
        return self.digests[-1] if self.digests else hashlib.sha256().hexdigest()


def recording_digest(recording: Path | str | None, frames: int) -> str:
    """Return the digest of a recording's first `frames` frames, as in a run's identity; "" if it has fewer."""
    with RecordingReader(recording or shipped.RECORDING) as reader:
        source = DigestedFrames(reader, frames)
        return source.digest if sum(1 for _ in source) == frames else ""
