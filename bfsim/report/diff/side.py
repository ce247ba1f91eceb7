"""One side of a comparison: the compared parts of a run that was just made, read back, or kept in a baseline."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import NamedTuple, TypeVar

SEPARATOR = "; "
"""Separates files, or numbers, of a configuration."""
FRAMES = "frames"
"""The name of the number of frames in a configuration. The digest of a recording covers only these."""


class Owner(NamedTuple):
    """An owner of cycles in a stage: a kernel, by its name and symbol, or something without a symbol, such as a ring."""

    stage: str
    name: str
    symbol: str


class Stall(NamedTuple):
    """What a line waits for: the reason, and the buffer, if there is one."""

    reason: str
    buffer: str


Operations = Mapping[str, tuple[int, int]]
"""How often each operation ran, and its issue cycles, as `LineCost` has it."""


Key = TypeVar("Key")


def _times(counts: Mapping[Key, int], share: Fraction) -> Mapping[Key, int]:
    return {key: round(count * share) for key, count in counts.items()}


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A source line of a kernel on all cores: how often it ran, its operations, and what it waited for in cycles.

    `number` is its place in the file, 0 where that was not kept.
    """

    text: str
    number: int = 0
    times: int = 0
    operations: Operations = field(default_factory=dict)
    stalls: Mapping[Stall, int] = field(default_factory=dict)

    @property
    def issue_cclk(self) -> int:
        """Cycles of its operations."""
        return sum(cclk for _, cclk in self.operations.values())

    @property
    def cclk(self) -> int:
        """Cycles of its operations and its waits."""
        return self.issue_cclk + sum(self.stalls.values())

    def scaled(self, share: Fraction) -> Line:
        """Return the line with a share of every number."""
        operations = {
            name: (round(count * share), round(cclk * share))
            for name, (count, cclk) in self.operations.items()
        }
        return replace(
            self,
            times=round(self.times * share),
            operations=operations,
            stalls=_times(self.stalls, share),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """The source of a kernel: its place, FILE:LINE, and its lines in order."""

    place: str
    lines: tuple[Line, ...]

    def scaled(self, share: Fraction) -> Source:
        """Return the source with a share of every number."""
        return replace(self, lines=tuple(each.scaled(share) for each in self.lines))


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """The compared parts of a run, in cycles of all cores over all of its `frames`, which are given by their index.

    `owners` do not include the time in which a core only waited for the other one or for the cameras: that is in
    `waits`, by stage. `sources` are those of kernels; there are none if lines cannot be compared. `memories` say where
    buffers lie. `frame_cclk` are the cycles of the slower core, by the frame's index. `results` are the published
    numbers, frame by frame or in total; `seen` are the names of what was seen, by the frame's index. Owners below
    `least_cclk` were not kept.
    """

    configuration: Mapping[str, str]
    cclk_hz: float
    frame_ms: float
    frames: tuple[int, ...]
    owners: Mapping[Owner, int]
    waits: Mapping[str, int]
    sources: Mapping[Owner, Source]
    memories: Mapping[str, str]
    frame_cclk: Mapping[int, int]
    results: Mapping[str, Sequence[int | None]]
    seen: Mapping[int, Counter[str]]
    least_cclk: int = 0

    def with_owners(self, owners: Mapping[Owner, int]) -> Side:
        """Return the side with other owners."""
        return replace(self, owners=owners)

    def with_stages(self, names: Mapping[str, str]) -> Side:
        """Return the side with new names for some stages, by their present ones."""

        def renamed(owner: Owner) -> Owner:
            return owner._replace(stage=names.get(owner.stage, owner.stage))

        return replace(
            self,
            owners={renamed(owner): cclk for owner, cclk in self.owners.items()},
            waits={names.get(stage, stage): cclk for stage, cclk in self.waits.items()},
            sources={renamed(owner): source for owner, source in self.sources.items()},
        )

    def without_lines(self) -> Side:
        """Return the side without sources."""
        return replace(self, sources={})

    def scaled(self, share: Fraction) -> Side:
        """Return the side with a share of every number that counts all frames."""
        return replace(
            self,
            owners=_times(self.owners, share),
            waits=_times(self.waits, share),
            sources={owner: each.scaled(share) for owner, each in self.sources.items()},
            frame_cclk={},
            results={},
            seen={},
            least_cclk=round(self.least_cclk * share),
        )

    @property
    def cclk(self) -> int:
        """All cycles, waits included."""
        return sum(self.owners.values()) + sum(self.waits.values())
