"""What an LDF says once it has been read: memory segments, and output sections that fill them in order."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cached_property
from pathlib import Path

from bfsim.linker.expressions import Expression
from bfsim.linker.link_map import Symbol
from bfsim.linker.source import LdfLine, Source

CORE_OF_PROCESSOR = {"p0": "A", "p1": "B"}  # the names that the default LDFs of the BF561 give the cores
DUAL_CORE_CHIPS = ("ADSP-BF561",)
MEMORY_FUNCTIONS = ("MEMORY_START", "MEMORY_END", "MEMORY_SIZEOF")
COMMAND_LINE_OBJECTS = "$COMMAND_LINE_OBJECTS"


@dataclass(frozen=True, slots=True)
class Statement:
    """Something that stands in a certain `place` of the LDF."""

    place: LdfLine

    @property
    def line(self) -> int:
        """Line of its file, from 1."""
        return self.place.line


@dataclass(frozen=True, slots=True)
class Segment(Statement):
    """A stretch of memory: `nbytes` from address `start`. `processor` is empty in the global MEMORY block."""

    name: str
    start: int
    nbytes: int
    processor: str = ""

    @property
    def end(self) -> int:
        """Address of the last byte."""
        return self.start + self.nbytes - 1

    def overlaps(self, other: Segment) -> bool:
        """Return whether a byte lies in both."""
        return self.start <= other.end and other.start <= self.end


def memory_function(function: str, segment: Segment) -> int:
    """Return MEMORY_START, MEMORY_END or MEMORY_SIZEOF of a segment."""
    values = {"MEMORY_START": segment.start, "MEMORY_END": segment.end, "MEMORY_SIZEOF": segment.nbytes}
    return values[function]


@dataclass(frozen=True, slots=True)
class Input:
    """The input sections `sections`, which may have the wildcards * and ?, of the object files `files`."""

    files: frozenset[str]
    sections: frozenset[str]

    def takes_file(self, symbol: Symbol) -> bool:
        """Return whether `symbol` is from one of the files. A .doj is a command line object, a .dlb is not."""
        is_object = not symbol.object_file.endswith(".dlb")
        return symbol.object_file in self.files or (is_object and COMMAND_LINE_OBJECTS in self.files)

    def takes_section(self, symbol: Symbol) -> bool:
        """Return whether `symbol` lies in one of the sections."""
        return symbol.section in self.sections or any(
            fnmatchcase(symbol.section, section) for section in self.sections if {*section} & {*"*?"}
        )

    def takes(self, symbol: Symbol) -> bool:
        """Return whether `symbol` lies in one of the sections of one of the files."""
        return self.takes_file(symbol) and self.takes_section(symbol)


@dataclass(frozen=True, slots=True)
class InputSections(Statement):
    """An INPUT_SECTIONS statement; `align` is the INPUT_SECTION_ALIGN, in bytes, in force there.

    What a pinned one takes goes to no output section before it, and to no other at all if it `is_exclusive`.
    """

    inputs: tuple[Input, ...]
    align: int
    is_pinned: bool = False
    is_exclusive: bool = False

    def takes(self, symbol: Symbol) -> bool:
        """Return whether `symbol` is one of the statement's inputs."""
        return any(source.takes(symbol) for source in self.inputs)


@dataclass(frozen=True, slots=True)
class Reserve(Statement):
    """A RESERVE inside an output section: `nbytes` at the location pointer, moved up to `align`.

    One that takes the rest gets what follows up to the next fixed reserve, `nbytes` at least. One that
    expands gets, when everything else has its place, the largest stretch that is free.
    """

    name: str
    length_name: str
    nbytes: int
    align: int
    takes_rest: bool = False
    expands: bool = False


@dataclass(frozen=True, slots=True)
class FixedReserve(Statement):
    """A RESERVE with an address: `nbytes` from `start` that no symbol may use."""

    name: str
    length_name: str
    start: int
    nbytes: int
    processor: str | None

    def is_same_as(self, other: FixedReserve) -> bool:
        """Return whether both reserve the same bytes, each for its own processor."""
        return (self.start, self.nbytes) == (other.start, other.nbytes) and self.processor != other.processor


@dataclass(frozen=True, slots=True)
class Assignment(Statement):
    """A `symbol = expression;`, where "." is the location counter."""

    symbol: str
    expression: Expression


@dataclass(frozen=True, slots=True)
class Move(Statement):
    """An ALIGN: the location pointer goes up to a multiple of `align`."""

    align: int


@dataclass(frozen=True, slots=True)
class OutputSection(Statement):
    """An output section: statements that fill `segment` one after the other; without one it takes nothing."""

    name: str
    statements: tuple[InputSections | Reserve | Assignment | Move, ...]
    segment: str
    is_contiguous: bool


@dataclass(frozen=True, slots=True)
class Resolve(Statement):
    """A RESOLVE: where the processor expects the symbol `name`."""

    name: str
    address: int


@dataclass(frozen=True, slots=True)
class Block(Statement):
    """A PROCESSOR, COMMON_MEMORY or SHARED_MEMORY block; the latter two also take what both cores share.

    `loose` are the assignments outside its output sections.
    """

    title: str
    processors: tuple[str, ...]
    is_shared: bool
    output_sections: tuple[OutputSection, ...]
    resolves: tuple[Resolve, ...]
    loose: tuple[Assignment, ...]

    @property
    def processor(self) -> str | None:
        """The processor that owns what is defined here; None if several share it."""
        return None if self.is_shared else self.processors[0]

    @property
    def assignments(self) -> dict[str, int]:
        """The symbols that are assigned a number here, whatever is linked."""
        return {
            each.symbol: each.expression.number for each in self._assignments() if each.expression.is_number
        }

    def serves(self, symbol: Symbol) -> bool:
        """Return whether the block places symbols of this one's processor."""
        return self.is_shared if symbol.processor is None else symbol.processor in self.processors

    def _assignments(self) -> Iterator[Assignment]:
        yield from self.loose
        for output in self.output_sections:
            yield from (each for each in output.statements if isinstance(each, Assignment))


@dataclass(frozen=True)
class LinkerScript:
    """A whole LDF. Segments have different names; blocks are in the order of the file.

    `chip` is empty without an ARCHITECTURE. `loose` are the assignments outside all blocks.
    """

    source: Source
    chip: str
    segments: tuple[Segment, ...]
    reserves: tuple[FixedReserve, ...]
    blocks: tuple[Block, ...]
    loose: tuple[Assignment, ...]

    @property
    def path(self) -> Path:
        """The LDF's file."""
        return self.source.path

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the #warning lines of the LDF say, each with its place."""
        return self.source.warnings

    @cached_property
    def segment_by_name(self) -> Mapping[str, Segment]:
        """The segments by their names."""
        return {segment.name: segment for segment in self.segments}

    @cached_property
    def _by_address(self) -> list[Segment]:
        return sorted(self.segments, key=lambda each: each.start)

    def segment_of(self, reserved: FixedReserve) -> Segment | None:
        """Return the segment that a reserve starts in; if several processors have that memory, one of theirs."""
        before = bisect(self._by_address, reserved.start, key=lambda each: each.start)
        segment = self._by_address[before - 1] if before else None
        return segment if segment and reserved.start <= segment.end else None

    @property
    def is_dual_core(self) -> bool:
        """Whether the LDF is for a chip with two cores; without an ARCHITECTURE it may be."""
        return not self.chip or self.chip in DUAL_CORE_CHIPS

    @cached_property
    def core_of_processor(self) -> Mapping[str, str]:
        """The core, "A" or "B", of each processor of the LDF: by name, or "A" if there is only one core."""
        if self.is_dual_core:
            return CORE_OF_PROCESSOR
        return {name: "A" for block in self.blocks for name in block.processors}

    def with_cores_named(self) -> LinkerScript:
        """Return the LDF with the name "p0" for the processor of a chip with a single core, whatever its name."""
        names = {name for block in self.blocks for name in block.processors}
        if self.is_dual_core or len(names) != 1:
            return self
        (core_a,) = (name for name, core in CORE_OF_PROCESSOR.items() if core == "A")
        segments = (replace(each, processor=core_a) if each.processor else each for each in self.segments)
        reserves = (replace(each, processor=core_a) if each.processor else each for each in self.reserves)
        blocks = (replace(each, processors=(core_a,)) for each in self.blocks)
        return replace(self, segments=tuple(segments), reserves=tuple(reserves), blocks=tuple(blocks))
