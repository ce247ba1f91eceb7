"""Arguments on the stack that are used once, outside loops: they are loaded where they are used [combine_and_move_insns in ira.cc of GCC 12].

So a function that returns early has not loaded it, and no register holds it until then.
"""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction
from bfsim.kernel.operations import Op


def load_where_used(context: Context, code: MachineCode) -> frozenset[str]:
    """Insert the loads of such arguments into `code`, and return their names."""
    on_stack = context.parameters()[operations.REGISTER_ARGUMENTS :]
    copied = context.operands_of("phi")
    found = set[str]()
    for name in on_stack:
        uses = [
            (label, instruction)
            for label, rows in code.of.items()
            for instruction in rows
            if any(used == name for used, _ in instruction.uses)
        ]
        if len(uses) == 1 and name not in copied and context.flow.innermost(uses[0][0]) is None:
            (label, instruction), rows = uses[0], code.of[uses[0][0]]
            bank = next(bank for used, bank in instruction.uses if used == name)
            load = MachineInstruction(Op.LOAD32, instruction.line, name, bank)
            number = next(number for number, each in enumerate(rows) if each is instruction)
            code.of[label] = [*rows[:number], load, *rows[number:]]
            found.add(name)
    return frozenset(found)
