"""Constants that are no immediates of the operation that uses them."""

from __future__ import annotations

from bfsim.kernel import isa
from bfsim.kernel.ir_text import SourceLine
from bfsim.kernel.isa import Op
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.machine_code import MachineCode, MachineInstruction, RegisterBank


def load_constant(
    constant: str, line: SourceLine, result: str | None = None, bank: RegisterBank = RegisterBank.ANY
) -> MachineInstruction:
    """Return the operation that loads a constant, written #5."""
    digits = constant[1:].lstrip("-")
    number = int(constant[1:]) if digits.isdigit() else 0
    if number in isa.SHORT_IMMEDIATE:
        return MachineInstruction(Op.IMM, line, result, bank)
    if number in isa.LONG_IMMEDIATE:
        return MachineInstruction(Op.IMM, line, result, bank, nbytes=isa.LONG_FORM_BYTES)
    return MachineInstruction(Op.IMM32, line, result, bank)


def keep_constants(flow: ControlFlow, code: MachineCode) -> None:
    """Load each constant once, before the outermost loop around its uses: it has a register from there on, as any value."""
    made: set[str] = set()
    for label in [each for each in flow.order if each in code.of]:
        loops = flow.loops_of(label)
        place = flow.entering(loops[-1]) if loops else label
        block: list[MachineInstruction] = []
        for instruction in code.of[label]:
            for name in [each for each, _ in instruction.uses if _is_loaded(each, instruction)]:
                kept = f"{name[1:]}@{place}"
                instruction.uses = tuple(
                    (kept if each == name else each, bank) for each, bank in instruction.uses
                )
                if kept not in made:
                    made.add(kept)
                    (block if place == label else code.of[place]).append(
                        load_constant(name, instruction.line, kept)
                    )
            block.append(instruction)
        code.of[label] = block


def _is_loaded(name: str, instruction: MachineInstruction) -> bool:
    is_choice = instruction.op is Op.COND_MOVE and name == "#poison"
    return name.startswith("#") and instruction.op is not Op.IMM and not is_choice
