"""What it takes to have each operand where its instruction can use it, once every web has a register [reload1.cc of GCC 12].

A move, or a load of what is in memory, at each use; only what a free register still holds is not brought again.
"""

from __future__ import annotations

from collections import Counter as Tally
from dataclasses import replace

from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.colouring import REGISTERS, SAVED, Colouring, is_call
from bfsim.kernel.lowering.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.lowering.register_classes import Operand, alternatives, takes_copy

DATA, POINTER, ANY, MEMORY = RegisterBank.DATA, RegisterBank.POINTER, RegisterBank.ANY, RegisterBank.MEMORY
ROOM = Tally(REGISTERS.values())


def reload(colouring: Colouring) -> None:
    """Insert moves, loads and stores into the code of a routine."""
    labels = colouring.webs.flow.order
    for label in labels:
        _make_room(colouring, label)
    for label in labels:
        colouring.webs.code.of[label] = _Block(colouring, label).code


def _make_room(colouring: Colouring, label: str) -> None:
    """Where no register is left for what an instruction needs, the least frequent web gives up its own."""
    webs, frequency = colouring.webs, colouring.classes.memory
    for instruction, behind in webs.forwards(label):
        way = _way(colouring, instruction, behind)
        own = {name for name, _ in way}
        needs = Tally(bank for name, bank in {*way} if bank and _is_elsewhere(colouring, (name, bank)))
        for bank, number in needs.items():
            here = {name for name in behind | own if webs.bank[name] is bank}
            while len(here) + number > ROOM[bank] and here - own:
                victim = min(here - own, key=lambda name: (frequency[name], name))
                colouring.evict(victim)
                here.discard(victim)


def _way(colouring: Colouring, instruction: MachineInstruction, behind: set[str]) -> list[Operand]:
    """The alternative that needs the fewest moves: one for each operand that is elsewhere, and one for the result."""

    def moves(way: list[Operand]) -> int:
        inputs, outputs = (way[:-1], way[-1:]) if instruction.result else (way, [])
        elsewhere = sum(_is_elsewhere(colouring, each) for each in [*dict.fromkeys(inputs), *outputs])
        return elsewhere + takes_copy(instruction, way, behind, colouring.webs)

    return min(alternatives(instruction, colouring.webs), key=moves, default=[])


def _is_elsewhere(colouring: Colouring, operand: Operand) -> bool:
    name, wanted = operand
    return colouring.webs.bank[name] not in ((wanted,) if wanted else (DATA, POINTER))


class _Block:
    """The `code` of one block, with its reloads; `held`: what is in registers that nothing else is in, the last one last."""

    def __init__(self, colouring: Colouring, label: str) -> None:
        self.colouring, self.webs, self.bank = colouring, colouring.webs, colouring.webs.bank
        self.label = label
        self.held: list[Operand] = []
        self.code: list[MachineInstruction] = []
        for instruction, behind in self.webs.forwards(label):
            if is_call(instruction):
                self._call(instruction, behind)
            elif way := _way(colouring, instruction, behind):
                self._instruction(instruction, way, behind)
            else:
                self._copy(instruction)

    def _instruction(self, instruction: MachineInstruction, way: list[Operand], behind: set[str]) -> None:
        start, fresh, operands = len(self.code), set[str](), iter(way)
        uses = tuple(
            self._input(instruction, use, next(operands), fresh) if use[0] in self.webs.defined else use
            for use in instruction.uses
        )
        self._keep(behind | {*self.webs.inputs(instruction)})
        over = {self.webs.find(name) for name in instruction.overwrites}
        if start and fresh & over and _is_copy_for(self.code[start - 1], instruction):
            del self.code[start - 1]  # what was reloaded may be overwritten
        if takes_copy(instruction, way, behind, self.webs):
            self.code.append(MachineInstruction(Op.MOVE, instruction.line, None, ANY))
        self.code.append(replace(instruction, uses=uses))
        for name in self.webs.results(instruction):
            self._forget(name)
            self._output(name, way[-1], instruction)

    def _input(
        self,
        instruction: MachineInstruction,
        use: tuple[str, RegisterBank],
        operand: Operand,
        fresh: set[str],
    ) -> tuple[str, RegisterBank]:
        """Bring an operand to where it is wanted, if it is not there."""
        name, wanted = operand[0], operand[1] or DATA
        if not _is_elsewhere(self.colouring, operand):
            return use[0], self.bank[name]
        copy = f"{use[0]}@{wanted.value}.{self.label}"
        self.bank[copy] = wanted
        if (name, wanted) in self.held:
            self.held.remove((name, wanted))
        else:
            fresh.add(name)
            op = Op.LOAD32 if self.bank[name] is MEMORY else Op.MOVE
            self.code.append(MachineInstruction(op, instruction.line, copy, wanted, ((use[0], ANY),)))
        self.held.append((name, wanted))
        return copy, wanted

    def _output(self, name: str, operand: Operand, instruction: MachineInstruction) -> None:
        """Move a result to where it lives, if it is computed elsewhere."""
        if not _is_elsewhere(self.colouring, operand):
            return
        wanted = operand[1] or DATA
        self.code[-1].bank = wanted
        self.code.append(self._stored(instruction) if self.bank[name] is MEMORY else replace(
            instruction, op=Op.MOVE, bank=ANY, uses=((instruction.result or "", ANY),), overwrites=(), less="",
            cclk=None, nbytes=None, access=None,
        ))  # fmt: skip
        self.held.append((name, wanted))

    def _copy(self, instruction: MachineInstruction) -> None:
        """A copy takes what is in any register; from memory it is a load, to memory a store."""
        from_memory = any(self.bank[name] is MEMORY for name in self.webs.inputs(instruction))
        to_memory = any(self.bank[name] is MEMORY for name in self.webs.results(instruction))
        if instruction.op is Op.MOVE and from_memory:
            instruction = replace(instruction, op=Op.LOAD32)
        elif instruction.op is Op.MOVE and to_memory:
            instruction, to_memory = replace(instruction, op=Op.STORE32), False
        self.code += [instruction, *([self._stored(instruction)] if to_memory else [])]
        for name in self.webs.results(instruction):
            self._forget(name)

    def _call(self, call: MachineInstruction, behind: set[str]) -> None:
        """What is in a register that calls destroy is saved before and restored behind [caller-save.cc]."""
        register, own = self.colouring.register, self.webs.results(call)
        saved = sum(name in register and register[name] not in {None, *SAVED} for name in behind - {*own})
        self.held = []
        self.code += [self._stored(call)] * saved
        self.code.append(call)
        self.code += [MachineInstruction(Op.LOAD32, call.line, None, ANY)] * saved
        for name in own:
            if self.bank[name] is MEMORY:
                self.code.append(self._stored(call))
            elif self.bank[name] is not DATA:
                self.code.append(MachineInstruction(Op.MOVE, call.line, None, ANY))

    def _keep(self, alive: set[str]) -> None:
        """Forget what is in registers that are no longer free."""
        free = ROOM - Tally(self.bank[name] for name in alive)
        kept: list[Operand] = []
        for name, bank in reversed(self.held):
            if bank is not None and free[bank] > 0:
                free[bank] -= 1
                kept.append((name, bank))
        self.held = kept[::-1]

    def _forget(self, name: str) -> None:
        self.held = [each for each in self.held if each[0] != name]

    def _stored(self, instruction: MachineInstruction) -> MachineInstruction:
        return MachineInstruction(Op.STORE32, instruction.line, None, ANY)


def _is_copy_for(before: MachineInstruction, instruction: MachineInstruction) -> bool:
    """Whether the instruction before only saves an operand that this one overwrites."""
    return bool(instruction.overwrites) and before.op is Op.MOVE and before.result is None and not before.uses
