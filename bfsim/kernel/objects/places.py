"""The kernel, and the line of it, that each instruction of an image belongs to."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from bfsim.blackfin.elf.image import Image, Routine
from bfsim.files import store
from bfsim.kernel import keys
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.language.function import Function, Parameter
from bfsim.kernel.objects.sources import Source, SourceFiles, disassembly, file_lines, source_of
from bfsim.kernel.types import Number

if TYPE_CHECKING:
    from bfsim.blackfin.elf.lines import Line, LineTable


@dataclass
class Places:
    """The lines of an image.

    `kernels`: those that are functions in it, by their symbols there. `of_file`: kernels by the file that the debugging
    information names for their lines. `files`: where other source files are.
    """

    image: Image
    kernels: Mapping[str, Function]
    of_file: Mapping[str, Function] = field(default_factory=dict)
    files: SourceFiles | None = None
    functions: dict[str, Function] = field(default_factory=dict)
    """All functions that instructions were found to belong to, by their own symbols."""
    _sources: dict[str, tuple[Function, Source]] = field(default_factory=dict)

    @cached_property
    def lines(self) -> LineTable:
        """What the debugging information says of addresses; it takes seconds to read if libraries have some."""
        # most starts find all that depends on it
        from bfsim.blackfin.elf.lines import Line, LineTable, Row, lines_of

        key = keys.object_key(self.image.digest, "", "", "lines")
        rows = store.kept(key, lambda: [(each.address, each.line) for each in lines_of(self.image).rows])
        return LineTable(tuple([Row(address, Line(*line) if line else None) for address, line in rows]))

    @cached_property
    def sources_digest(self) -> str:
        """Digest of all source files that functions may be shown from; '' if none are looked for."""
        if self.files is None:
            return ""
        named = sorted({each.line.file for each in self.lines.rows if each.line})
        texts = [path and file_lines(path) for path in map(self.files.named, named)]
        return hashlib.sha256(repr((named, texts)).encode(errors="surrogatepass")).hexdigest()

    def line_of(self, address: int) -> SourceLine:
        """Return the line of the instruction at an address."""
        line = self._line_in_kernel(address)
        if line is not None:
            function = self.of_file[line.file]
            self.functions[function.symbol] = function
            # code that leaves the function has the line of the closing brace in C, which is after the last line of Python
            last = len(function.lines)
            return SourceLine(function.symbol, min(line.line, last))
        function, source = self._source(self._routine(address))
        return SourceLine(function.symbol, source.lines.get(address, 1))

    def _line_in_kernel(self, address: int) -> Line | None:
        """Return the line of a kernel that the instruction at an address belongs to, None if it belongs to no kernel.

        Code from one of bfsim's own files, such as the floor division, belongs to the line that calls it; if the
        compiler mentions no call, to the line before.
        """
        line = self._line_told(address)
        if line is not None:  # most often; looking for the routine takes longer
            return line
        routine = self._routine(address)
        begin = routine.address if routine.name in self.kernels else address
        lines = map(self._line_told, range(address - 2, begin - 1, -2))
        return next((each for each in lines if each), None)

    def _line_told(self, address: int) -> Line | None:
        line = self.lines.at(address)
        if line is None or line.file in self.of_file:
            return line
        return self._lines_of_calls.get(address)

    @cached_property
    def _lines_of_calls(self) -> Mapping[int, Line]:
        """For the address of an inlined instruction, the line of the innermost call in a file of kernels that it replaces."""
        from bfsim.blackfin.elf.lines import calls_inlined_in

        found: dict[int, Line] = {}
        for each in reversed(calls_inlined_in(self.image) if self.of_file else ()):
            if each.line.file in self.of_file:
                found |= dict.fromkeys(range(each.begin, each.end, 2), each.line)
        return found

    def function_at(self, address: int) -> Function:
        """Return the kernel or other function that has the code at an address, also in a clone, such as `_row.constprop.0`.

        The code of a kernel may begin with a line of another one that is inlined in it.
        """
        routine = self._routine(address)
        kernel = self.kernels.get(routine.name.partition(".")[0])
        if kernel is None:
            return self.functions[self.line_of(routine.address).routine]
        return self.functions.setdefault(kernel.symbol, kernel)

    def function_called(self, symbol: str) -> Function:
        """Return the kernel or other function of the image that has its own symbol `symbol`."""
        if symbol not in self.functions:
            if found := self._by_symbol.get(symbol) or self.of_file.get(symbol):
                self.functions[symbol] = found
            else:
                routines = (each for each in self.image.routines if each.name == symbol)
                self._source(next(routines, Routine(symbol, 0, 0)))
        return self.functions[symbol]

    @cached_property
    def _by_symbol(self) -> Mapping[str, Function]:
        return {each.symbol: each for each in self.kernels.values()}

    def entered_at(self, address: int) -> str | None:
        """Return the symbol of the function that begins at an address, if one does."""
        routine = self._routine(address)
        return self.function_at(address).symbol if routine.address == address else None

    def library_routine_at(self, address: int) -> str:
        """Return the name of the routine of the compiler's library that has the code at an address; '' if none has."""
        from bfsim.kernel.c.library import is_of_library  # most starts find all that depends on it

        symbol = self._routine(address).name
        name = symbol.removeprefix("_")
        return name if symbol not in self.kernels and is_of_library(name) else ""

    def _routine(self, address: int) -> Routine:
        return self.image.routine_at(address) or Routine(f"code_{address:08x}", address, address)

    def _source(self, routine: Routine) -> tuple[Function, Source]:
        if routine.name not in self._sources:
            source = (
                source_of(self.image, self.lines, routine, self.files)
                if self.files
                else disassembly(self.image, routine)
            )
            known = self.kernels.get(routine.name)
            function = known or object_function(routine.name.removeprefix("_"), routine.name, source)
            self.functions[function.symbol] = function
            self._sources[routine.name] = function, source
        return self._sources[routine.name]


def object_function(
    name: str,
    symbol: str,
    source: Source,
    parameters: tuple[Parameter, ...] = (),
    result: Number | None = None,
) -> Function:
    """Return a function that has object code and no Python."""
    return Function(
        name=name,
        symbol=symbol,
        file=source.file,
        first_line=source.first_line,
        source=source.text,
        names={},
        is_static=False,
        parameters=parameters,
        result=result,
        calls=(),
        written=frozenset(),
        measured=frozenset(),
        digest="",
        read=_nothing,
    )


def _nothing() -> object:
    """Return the body of a function without Python."""
    from bfsim.kernel.language.tree import Body  # no run asks for it

    return Body((), ())
