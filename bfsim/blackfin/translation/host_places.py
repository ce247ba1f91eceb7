"""The instruction of the Blackfin behind an access in native code, by a table of lines: each line is a Blackfin address.

A fault leaves native code without a word; the table still tells which instruction made it, and slows nothing down.
"""

from __future__ import annotations

import io
from collections.abc import Collection
from typing import Any

from elftools.elf.elffile import ELFFile
from llvmlite import ir


class HostPlaces:
    """The table of lines of a function that is being made."""

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
        """Return the mark of an access by the instruction at an address."""
        return self._module.add_debug_info("DILocation", {"line": address, "scope": self._scope})


def instructions_at(code: bytes, offset: int, accessing: Collection[int]) -> list[int]:
    """Return the addresses of the instructions one of which made the access at `offset` in native code.

    `code`: the object file of the host. `accessing`: all that access memory. An access that LLVM has moved or merged
    belongs to one of those that have no place of their own. There are none for code without such a table.
    """
    file = ELFFile(io.BytesIO(code))
    if file.get_section_by_name(".debug_line") is None:  # trusted code has none
        return []
    tables = file.get_dwarf_info(relocate_dwarf_sections=False)
    programs = [tables.line_program_for_CU(unit) for unit in tables.iter_CUs()]
    states = [each.state for program in programs if program for each in program.get_entries()]
    lines = {each.address: 0 if each.end_sequence else each.line for each in states if each}
    line = lines[max((each for each in lines if each <= offset), default=max(lines))]
    return [line] if line else sorted(set(accessing) - {*lines.values()})
