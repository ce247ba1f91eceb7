"""What a value costs in each class of registers, and in memory, by what each instruction can do with it [ira-costs.cc of GCC 12].

An instruction has alternatives: an addition is done in data registers or in pointer registers, a product in data registers
alone. An operand that is elsewhere takes a move, as often as the instruction is executed. Each class is priced twice: first every
value by itself, then beside the classes that the operands are best in.
"""

from __future__ import annotations

from collections import defaultdict

from bfsim.kernel import isa
from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.lowering.webs import Webs

MOVE = 2  # between any two classes of registers [bfin_register_move_cost]
MEMORY = 8  # of a data or pointer register from or to memory [bfin_memory_move_cost]
DATA, POINTER, ANY = RegisterBank.DATA, RegisterBank.POINTER, RegisterBank.ANY
INDEX, MODIFY, BASE = RegisterBank.INDEX, RegisterBank.MODIFY, RegisterBank.BASE
BANKS = (DATA, POINTER, INDEX, MODIFY, BASE)
COPIES = {Op.MOVE, Op.IMM, Op.IMM32}  # take and leave values in registers of any class
SEPARATE = {Op.COND_MOVE, Op.STORE32, Op.LOAD32}  # whose operands may be in different classes
COMMUTATIVE = {Op.ALU, Op.MUL16, Op.MUL32, Op.DSP_ALU}

Operand = tuple[str, RegisterBank | None]
"""A web and the class that it has to be in; None: a data or a pointer register."""
Costs = dict[RegisterBank, float]


class RegisterClasses:
    """Costs of the webs of a routine, weighted with how often blocks are executed: `of` each class, and of `memory`."""

    def __init__(self, webs: Webs) -> None:
        self.webs = webs
        alone = self._costs({})
        self.of = self._costs({name: _best(costs) for name, costs in alone.items()})
        self.memory = self._memory()

    def _costs(self, best: dict[str, set[RegisterBank]]) -> dict[str, Costs]:
        found: defaultdict[str, Costs] = defaultdict(lambda: dict.fromkeys(BANKS, 0.0))
        for label in self.webs.code.of:
            for instruction, alive in self.webs.backwards(label):
                ways = alternatives(instruction, self.webs)
                prices = [
                    sum(not _fits(best.get(name), wanted) for name, wanted in way)
                    + takes_copy(instruction, way, alive, self.webs)
                    for way in ways
                ]
                tried = 2 if _commutes(instruction) else 1  # GCC adds up what it costs either way round
                for place, (name, _) in enumerate(ways[0] if ways else ()):
                    for bank in BANKS:
                        moves = min(
                            price + (not _fits({bank}, way[place][1]))
                            for price, way in zip(prices, ways, strict=True)
                        )
                        found[name][bank] += tried * MOVE * self.webs.frequency[label] * moves
        return {name: found[name] for name in self.webs.names()}

    def _memory(self) -> dict[str, float]:
        found = dict.fromkeys(self.webs.names(), 0.0)
        for label, block in self.webs.code.of.items():
            for name in (name for instruction in block for name in self.webs.operands(instruction)):
                found[name] += MEMORY * self.webs.frequency[label]
        in_memory = map(self.webs.find, self.webs.context.parameters()[isa.REGISTER_ARGUMENTS :])
        for name in found.keys() & in_memory:
            found[name] -= 2 * MEMORY  # neither is it loaded when the routine starts, nor stored
        return found


def alternatives(instruction: MachineInstruction, webs: Webs) -> list[list[Operand]]:
    """Return the ways to do an instruction: of each, the class of each operand, with the result last; none of a copy."""
    operands = [(webs.find(name), bank) for name, bank in instruction.uses if name in webs.defined]
    if instruction.result:
        operands.append((webs.find(instruction.result), instruction.bank))
    if instruction.op in COPIES or not operands:
        return []
    free = sum(bank is ANY for _, bank in operands)
    if instruction.op in SEPARATE and free > 1:
        return [[(name, None if bank is ANY else bank) for name, bank in operands]]
    in_index = _in_index_register(instruction, operands) if free == len(operands) == 3 else []
    return in_index + [
        [(name, choice if bank is ANY else bank) for name, bank in operands]
        for choice in ((DATA, POINTER) if free else (DATA,))
    ]


def _in_index_register(
    instruction: MachineInstruction, operands: list[tuple[str, RegisterBank]]
) -> list[list[Operand]]:
    """What is in an index register is added to in place, from a modify register [addsi3 in bfin.md]."""
    *terms, result = (name for name, _ in operands)
    if instruction.op is not Op.ALU or instruction.less or result not in terms:
        return []
    return [[*((name, INDEX if name == result else MODIFY) for name in terms), (result, INDEX)]]


def takes_copy(instruction: MachineInstruction, way: list[Operand], alive: set[str], webs: Webs) -> bool:
    """Whether a pointer register that is subtracted from, in place, is wanted behind that [subsi3 in bfin.md]."""
    return bool(instruction.less) and way[0][1] is POINTER and webs.find(instruction.less) in alive


def _fits(best: set[RegisterBank] | None, wanted: RegisterBank | None) -> bool:
    return best is None or not best.isdisjoint((wanted,) if wanted else (DATA, POINTER))


def _commutes(instruction: MachineInstruction) -> bool:
    return instruction.op in COMMUTATIVE and len(instruction.uses) == 2 and not instruction.less


def _best(costs: Costs) -> set[RegisterBank]:
    least = min(costs.values())
    return {bank for bank, cost in costs.items() if cost <= least}
