"""Registers: a model of what an allocator's result costs, not an allocator.

It counts the moves between the banks, the constants, the reloads and the saved registers, and places them where an
allocator would: see `webs`, `moves` and `pressure`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from bfsim.kernel import operations
from bfsim.kernel.estimate.registers.argument_loads import load_where_used
from bfsim.kernel.estimate.registers.byte_addresses import add_in_data_registers
from bfsim.kernel.estimate.registers.expansion_order import order_as_expanded
from bfsim.kernel.estimate.registers.half_word_pointers import HalfWordPointers
from bfsim.kernel.estimate.registers.index_registers import IndexRegisters
from bfsim.kernel.estimate.registers.moves import Moves
from bfsim.kernel.estimate.registers.pressure import Pressure
from bfsim.kernel.estimate.registers.register_classes import RegisterClasses
from bfsim.kernel.estimate.registers.taken_registers import TakenRegisters
from bfsim.kernel.estimate.registers.waiting_arguments import let_arguments_wait
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule


@dataclass(slots=True)
class Allocation:
    """What the registers of one routine cost besides its operations, and where each value is."""

    bank: dict[str, RegisterBank]
    register: dict[str, str]
    """Values that share a register, by a name for it."""
    alive: dict[str, frozenset[str]]
    """The registers that are live after each block."""
    on_edges: dict[tuple[str, str], list[MachineInstruction]]
    calls: bool
    entry: list[MachineInstruction] = field(default_factory=list)
    saved_data: int = 0
    saved_pointers: int = 0
    saves_frame_pointer: bool = False


def allocate(context: Context, code: MachineCode) -> Allocation:
    """Insert moves, constants and reloads into `code`; return those that belong to edges and to the function's ends."""
    loads_late = context.profile.applies(Rule.ARGUMENT_LOADS)
    loaded = load_where_used(context, code) if loads_late else frozenset()
    if context.profile.applies(Rule.BYTE_ADDRESSES):
        add_in_data_registers(context, code)
    if context.profile.applies(Rule.EXPANSION_ORDER):
        order_as_expanded(context, code)
    webs = Webs(context, code)
    if context.profile.applies(Rule.SUM_CLASSES):
        RegisterClasses(webs).place()
    if context.profile.applies(Rule.HALF_WORD_POINTERS):
        HalfWordPointers(webs).place()
    if context.profile.applies(Rule.ADDRESS_CLASSES):
        let_arguments_wait(webs)
    moves = Moves(webs)
    if context.profile.applies(Rule.INDEX_REGISTERS):
        IndexRegisters(webs).place()
    pressure = Pressure(webs)
    names = (*webs.web, *webs.bank)
    result = Allocation(
        bank={name: webs.bank[webs.find(name)] for name in names if webs.find(name) in webs.bank},
        register={name: webs.find(name) for name in webs.web},
        alive={label: frozenset(map(webs.find, out)) for label, out in webs.live.out.items()},
        on_edges=moves.on_edges,
        calls=any(instruction.op is Op.CALL for block in code.of.values() for instruction in block),
    )
    _Ends(webs, pressure, result, loaded).save()
    return result


class _Ends:
    """The registers that a function saves when it is entered, and where its arguments go."""

    def __init__(self, webs: Webs, pressure: Pressure, result: Allocation, loaded: frozenset[str]) -> None:
        """`loaded`: arguments that are loaded where they are used."""
        self.webs, self.pressure, self.result, self.loaded = webs, pressure, result, loaded
        self.flow, self.code, self.bank = webs.flow, webs.code, webs.bank
        self.taken = TakenRegisters(webs, pressure)

    def save(self) -> None:
        """Find the registers that are saved, and load or move the arguments."""
        across = {bank: set[str]() for bank in RegisterBank}
        for label in self.flow.blocks:
            for alive in self.pressure.points(label, across_calls=True):
                for name in alive:
                    across[self.bank.get(name, RegisterBank.DATA)].add(name)
        data = self.taken.most(RegisterBank.DATA) - operations.SCRATCH_DATA_REGISTERS
        pointers = self.taken.most(RegisterBank.POINTER) - operations.SCRATCH_POINTER_REGISTERS
        if self.result.calls:
            data, pointers = (
                max(data, len(across[RegisterBank.DATA])),
                max(pointers, len(across[RegisterBank.POINTER])),
            )
        self.result.saved_data = min(max(data, 0), 4)
        self.result.saved_pointers = min(max(pointers, 0), 3)
        self.result.saves_frame_pointer = pointers > 3
        if self.webs.context.profile.applies(Rule.KEPT_RESULTS):
            self._results()
        self._parameters(across)
        self._load_staying()

    def _results(self) -> None:
        """The next call destroys R0: a result that is used after it moves to a register that survives."""
        kept = self._kept_results()
        for label, block in self.code.of.items():
            moved: list[MachineInstruction] = []
            for instruction in block:
                moved.append(instruction)
                if instruction.op is Op.CALL and instruction.result in kept:
                    moved.append(MachineInstruction(Op.MOVE, instruction.line, None, RegisterBank.ANY))
            self.code.of[label] = moved

    def _kept_results(self) -> set[str]:
        """Values that are alive across a call."""
        kept: set[str] = set()
        for label, block in self.code.of.items():
            alive = set(self.webs.live.out[label])
            for instruction in reversed(block):
                alive.discard(instruction.result or "")
                if (
                    instruction.op is Op.CALL and instruction.code_bytes
                ):  # not those that a library routine itself calls
                    kept |= alive
                alive.update(name for name, _ in instruction.uses)
        return kept

    def _parameters(self, across: dict[RegisterBank, set[str]]) -> None:
        used = {
            name for block in self.code.of.values() for instruction in block for name, _ in instruction.uses
        }
        used |= {value for arms in self.webs.phis.values() for value, _ in arms}
        line = self.flow.routine.blocks[0].instructions[0].line
        for number, name in enumerate(self.webs.context.parameters()):
            if name not in used or name in self.loaded | self.taken.staying:
                continue
            bank = self.bank.get(self.webs.find(name), RegisterBank.DATA)
            if number >= operations.REGISTER_ARGUMENTS:
                self.result.entry.append(MachineInstruction(Op.LOAD32, line, None, bank))
            elif bank is RegisterBank.POINTER or name in across[bank]:
                self.result.entry.append(MachineInstruction(Op.MOVE, line, None, bank))

    def _load_staying(self) -> None:
        """Load arguments that stay on the stack where they are used, or where a phi takes them."""
        for name in self.taken.staying:
            for label, block in self.code.of.items():
                self.code.of[label] = [row for each in block for row in self._loaded(name, each)]
            for phi, arms in self.webs.phis.items():
                home, each = self.flow.defined[phi]
                for value, label in arms:
                    if value == name and self.webs.find(value) == self.webs.find(phi):
                        load = MachineInstruction(Op.LOAD32, each.line, None, RegisterBank.ANY)
                        self.result.on_edges.setdefault((label, home), []).append(load)

    def _loaded(self, name: str, instruction: MachineInstruction) -> list[MachineInstruction]:
        """An instruction, with the load of the argument `name` if it uses that; a copy becomes a load."""
        if name not in (used for used, _ in instruction.uses):
            return [instruction]
        load = MachineInstruction(Op.LOAD32, instruction.line, instruction.result, instruction.bank)
        return [load] if instruction.op is Op.MOVE else [load, instruction]
