"""What an LDF says once it has been read: memory segments, and output sections that fill them in order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bfsim.linker.link_map import Symbol

CORE_OF_PROCESSOR = {"p0": "A", "p1": "B"}  # the names that the default LDFs of the BF561 give the cores
COMMAND_LINE_OBJECTS = "$COMMAND_LINE_OBJECTS"


@dataclass(frozen=True, slots=True)
class Segment:
    """A stretch of memory: `nbytes` from address `start`. `processor` is empty in the global MEMORY block."""

    name: str
    start: int
    nbytes: int
    line: int
    processor: str = ""

    @property
    def end(self) -> int:
        """Address of the last byte."""
        return self.start + self.nbytes - 1


@dataclass(frozen=True, slots=True)
class Input:
    """The input sections `sections` of the object files `files`."""

    files: frozenset[str]
    sections: frozenset[str]

    def takes_file(self, symbol: Symbol) -> bool:
        """Say whether `symbol` is from one of the files. A .doj is a command line object, a .dlb is not."""
        is_object = not symbol.object_file.endswith(".dlb")
        return symbol.object_file in self.files or (is_object and COMMAND_LINE_OBJECTS in self.files)

    def takes(self, symbol: Symbol) -> bool:
        """Say whether `symbol` lies in one of the sections of one of the files."""
        return symbol.section in self.sections and self.takes_file(symbol)


@dataclass(frozen=True, slots=True)
class InputSections:
    """An INPUT_SECTIONS statement; `align` is the INPUT_SECTION_ALIGN, in bytes, in force there."""

    inputs: tuple[Input, ...]
    align: int
    line: int

    def takes(self, symbol: Symbol) -> bool:
        """Say whether `symbol` is one of the statement's inputs."""
        return any(source.takes(symbol) for source in self.inputs)


@dataclass(frozen=True, slots=True)
class Reserve:
    """A RESERVE inside an output section: `nbytes` at the location pointer, moved up to `align`."""

    name: str
    nbytes: int
    align: int
    line: int


@dataclass(frozen=True, slots=True)
class FixedReserve:
    """A RESERVE with an address: `nbytes` from `start` that no symbol may use."""

    name: str
    start: int
    nbytes: int
    line: int


@dataclass(frozen=True, slots=True)
class OutputSection:
    """An output section: statements that fill `segment` one after the other."""

    name: str
    statements: tuple[InputSections | Reserve, ...]
    segment: str
    is_contiguous: bool
    line: int


@dataclass(frozen=True, slots=True)
class Resolve:
    """A RESOLVE: where the processor expects the symbol `name`."""

    name: str
    address: int
    line: int


@dataclass(frozen=True, slots=True)
class Block:
    """A PROCESSOR, COMMON_MEMORY or SHARED_MEMORY block; the latter two also take what both cores share."""

    title: str
    processors: tuple[str, ...]
    is_shared: bool
    output_sections: tuple[OutputSection, ...]
    resolves: tuple[Resolve, ...]
    line: int

    def serves(self, symbol: Symbol) -> bool:
        """Say whether the block places symbols of this one's processor."""
        return self.is_shared if symbol.processor is None else symbol.processor in self.processors


@dataclass(frozen=True, slots=True)
class LinkerScript:
    """A whole LDF. Segments do not overlap and have different names; blocks are in the order of the file."""

    path: Path
    segments: tuple[Segment, ...]
    reserves: tuple[FixedReserve, ...]
    blocks: tuple[Block, ...]
