"""Which instruction of the Blackfin an access in native code is of: that has a table of lines, whose lines are the Blackfin's addresses.

So a fault, at which native code is left without a word, is told with the instruction that has made it, and nothing is slower for that.
"""

from __future__ import annotations

import io
from collections.abc import Collection
from typing import Any

from elftools.elf.elffile import ELFFile
from llvmlite import ir


class HostPlaces:
    """The table of lines of a function while it is made."""

    def __init__(self, module: ir.Module, function: ir.Function) -> None:
        file = module.add_debug_info("DIFile", {"filename": "blackfin", "directory": ""})
        unit = module.add_debug_info(
            "DICompileUnit",
            {"language": ir.DIToken("DW_LANG_C"), "file": file, "emissionKind": ir.DIToken("LineTablesOnly")},
            is_distinct=True,
        )
        kind = module.add_debug_info("DISubroutineType", {"types": module.add_metadata([])})
        self._module = module
        self._scope = module.add_debug_info(
            "DISubprogram",
            {
                "name": function.name,
                "file": file,
                "type": kind,
                "unit": unit,
                "spFlags": ir.DIToken("DISPFlagDefinition"),
            },
            is_distinct=True,
        )
        function.set_metadata("dbg", self._scope)
        version = [ir.IntType(32)(2), "Debug Info Version", ir.IntType(32)(3)]
        module.add_named_metadata("llvm.module.flags", version)
        module.add_named_metadata("llvm.dbg.cu", unit)

    def of(self, address: int) -> Any:
        """Return what an access by the instruction at an address is marked with."""
        return self._module.add_debug_info("DILocation", {"line": address, "scope": self._scope})


def instructions_at(code: bytes, offset: int, accessing: Collection[int]) -> list[int]:
    """Return the addresses of the instructions of which one has made the access that native code makes so far behind its beginning.

    `code`: the object file of the host. `accessing`: all that access memory. What LLVM has moved, or made of several, is of one of those
    that have no place of their own. Of code without such a table none is returned.
    """
    file = ELFFile(io.BytesIO(code))
    if file.get_section_by_name(".debug_line") is None:  # of code that is not held to be right
        return []
    tables = file.get_dwarf_info(relocate_dwarf_sections=False)
    programs = [tables.line_program_for_CU(unit) for unit in tables.iter_CUs()]
    states = [each.state for program in programs if program for each in program.get_entries()]
    lines = {each.address: 0 if each.end_sequence else each.line for each in states if each}
    line = lines[max((each for each in lines if each <= offset), default=max(lines))]
    return [line] if line else sorted(set(accessing) - {*lines.values()})
