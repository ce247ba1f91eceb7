"""Putting every value in the right bank: copies, moves, and constants that are no immediates."""

from __future__ import annotations

from collections.abc import Container

from bfsim.kernel.estimate.arithmetic.multiples import STEP
from bfsim.kernel.estimate.registers.phi_copies import PhiCopies
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.constants import load_constant
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule


class Moves:
    """Inserts the moves into the code of a routine; `on_edges`: those that belong to an edge."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.flow, self.code = webs, webs.flow, webs.code
        self.find, self.bank = webs.find, webs.bank
        self.on_edges = PhiCopies(webs).on_edges
        self._overwrites()
        if webs.context.profile.applies(Rule.SUM_CLASSES):
            self._move_back()
            self._move_on()
        self._moves()
        self._results()
        self._constants()

    def _overwrites(self) -> None:
        """Two-operand instructions destroy an operand; if it is still needed, it is copied first."""
        for label, block in self.code.of.items():
            alive = {self.find(name) for name in self.webs.live.out[label]}
            kept: list[MachineInstruction] = []
            for instruction in reversed(block):
                kept.append(instruction)
                if instruction.overwrites and self._destroys(instruction, label, alive):
                    kept.append(MachineInstruction(Op.MOVE, instruction.line, None, RegisterBank.ANY))
                if instruction.result:
                    alive.discard(self.find(instruction.result))
                alive.update(self.find(name) for name, _ in instruction.uses)
            self.code.of[label] = kept[::-1]

    def _destroys(self, instruction: MachineInstruction, label: str, alive: set[str]) -> bool:
        """Whether all operands that an instruction may overwrite are still needed, when `alive` are live after it.

        To GCC a conditional move may overwrite either operand, also a number, which was loaded for it, except in a
        loop: there it is loaded before.
        """
        own = self.find(instruction.result or "")
        by_rule = instruction.op is Op.COND_MOVE and self.webs.context.profile.applies(Rule.CONDITIONAL_MOVES)
        numbers = [name for name in instruction.overwrites if name.startswith("#")]
        others = [self.find(name) for name in instruction.overwrites if name not in numbers]
        if numbers and instruction.op is Op.SHIFT:
            return (
                self.flow.innermost(label) is not None
            )  # it is loaded before the loop, and shifted in each iteration
        if by_rule:
            is_kept = not numbers or ("#poison" not in numbers and self.flow.innermost(label) is not None)
        else:
            is_kept = bool(others)
        return is_kept and all(name in alive and name != own for name in others)

    def _moves(self) -> None:
        """Insert a move wherever a value is used in the other bank; outside the loop if the value does not change there."""
        reuses = self.webs.context.profile.applies(Rule.PRODUCT_STEPS)
        for label in self.flow.order:
            block: list[MachineInstruction] = []
            product, copied = "", set[str]()
            """What was moved for one product, or for products that begin alike: they reuse it [choose_reload_regs in reload1.cc]."""
            for instruction in self.code.of[label]:
                made = (instruction.result or "").partition(STEP)[0]
                if made != product:
                    product, copied = made, {each for each in copied if STEP in each}
                for position, (name, wanted) in enumerate(instruction.uses):
                    bank = self._wanted(instruction, wanted)
                    if name.startswith("#") or bank in (
                        RegisterBank.ANY,
                        self.bank.get(self.find(name), bank),
                    ):
                        continue
                    place = self._move_place(name, label)
                    copy = self._copy_of(name, bank, place)
                    move = MachineInstruction(
                        Op.MOVE, instruction.line, copy, bank, ((name, RegisterBank.ANY),)
                    )
                    is_there = (copy, bank) in instruction.uses[:position] or (reuses and copy in copied)
                    copied.add(copy)
                    if place == label and not is_there:
                        block.insert(
                            self._behind_definition(block, name) if bank is RegisterBank.DATA else len(block),
                            move,
                        )
                    elif place != label and not any(each.result == copy for each in self.code.of[place]):
                        self.code.add(place, move)
                    instruction.uses = (
                        *instruction.uses[:position],
                        (copy, bank),
                        *instruction.uses[position + 1 :],
                    )
                block.append(instruction)
            self.code.of[label] = block

    def _move_back(self) -> None:
        """Move the result of two values in pointer registers to a data register: one move, not two."""
        self._compute_where_both_are(RegisterBank.POINTER, RegisterBank.DATA)

    def _move_on(self) -> None:
        """Move the result of two values in data registers to a pointer register, unless it is part of an address.

        Such a part is added in pointer registers: (P + P) << 1 is one instruction.
        """
        parts = {
            name
            for block in self.code.of.values()
            for each in block
            if len(set(each.uses)) > 1
            for name, bank in each.uses
            if bank is RegisterBank.POINTER
        }
        self._compute_where_both_are(RegisterBank.DATA, RegisterBank.POINTER, but=parts)

    def _compute_where_both_are(
        self, own: RegisterBank, wanted: RegisterBank, but: Container[str] = ()
    ) -> None:
        """Compute the result of two values in their own bank, and move it to the bank in which it is wanted."""
        for label, block in self.code.of.items():
            found: list[MachineInstruction] = []
            for instruction in block:
                found.append(instruction)
                result = instruction.result
                is_free = instruction.op is Op.ALU and instruction.bank is RegisterBank.ANY
                if is_free and result and result not in but:
                    names = [name for name, _ in instruction.uses if not name.startswith("#")]
                    banks = [self.bank.get(self.find(name)) for name in (*names, result)]
                    if banks == [own] * 2 + [wanted]:
                        instruction.result = self._copy_of(result, own, "sum")
                        uses = ((instruction.result, RegisterBank.ANY),)
                        found.append(
                            MachineInstruction(Op.MOVE, instruction.line, result, RegisterBank.ANY, uses)
                        )
            self.code.of[label] = found

    def _results(self) -> None:
        """Put the returned value into R0, from the other bank by a move."""
        for label, block in self.flow.blocks.items():
            for value in block.terminator.operands if block.terminator.opcode == "ret" else ():
                name, line = self.webs.context.name(value), block.terminator.line
                if self.bank.get(self.find(name)) is RegisterBank.POINTER:
                    move = MachineInstruction(
                        Op.MOVE, line, None, RegisterBank.DATA, ((name, RegisterBank.ANY),)
                    )
                    self.code.add(label, move)
                elif name.startswith("#"):
                    self.code.add(label, load_constant(name, line))

    def _behind_definition(self, block: list[MachineInstruction], name: str) -> int:
        """The position right after the instruction that computes `name`, or the end: there the result in a pointer register moves back."""
        places = [number for number, instruction in enumerate(block) if instruction.result == name]
        return places[-1] + 1 if places else len(block)

    def _copy_of(self, name: str, bank: RegisterBank, place: str) -> str:
        copy = f"{name}@{bank.value}.{place}"
        self.bank[copy] = bank
        return copy

    def _wanted(self, instruction: MachineInstruction, bank: RegisterBank) -> RegisterBank:
        """The bank in which an operand is wanted: the bank of the result, or of the other operand."""
        if bank is not RegisterBank.ANY or instruction.op in (Op.STORE32, Op.MOVE):
            return bank
        if instruction.result:
            return self.bank.get(self.find(instruction.result), RegisterBank.DATA)
        banks = {
            self.bank.get(self.find(name), RegisterBank.DATA)
            for name, _ in instruction.uses
            if not name.startswith("#")
        }
        return banks.pop() if len(banks) == 1 else RegisterBank.DATA

    def _move_place(self, name: str, label: str) -> str:
        place = label
        for loop in self.flow.loops_of(label):
            if self._changes_in(self.find(name), loop):
                break
            place = self.flow.entering(loop)
        return place

    def _changes_in(self, web: str, loop: Loop) -> bool:
        if any(self.find(phi) == web and self.flow.defined[phi][0] in loop.blocks for phi in self.webs.phis):
            return True
        return any(
            instruction.result and self.find(instruction.result) == web
            for label in self.flow.inside(loop)
            for instruction in self.code.of[label]
        )

    def _constants(self) -> None:
        """Load each constant that is no immediate once, before the outermost loop around its use."""
        made: set[tuple[str, str]] = set()
        for label in self.flow.order:
            block: list[MachineInstruction] = []
            for instruction in self.code.of[label]:
                for name, _ in instruction.uses:
                    if (
                        not name.startswith("#")
                        or instruction.op is Op.IMM
                        or (instruction.op is Op.COND_MOVE and name == "#poison")
                    ):
                        continue
                    loops = self.flow.loops_of(label)
                    place = self.flow.entering(loops[-1]) if loops else label
                    if (name, place) in made:
                        continue
                    made.add((name, place))
                    if place == label:
                        block.append(load_constant(name, instruction.line))
                    else:
                        self.code.add(place, load_constant(name, instruction.line))
                block.append(instruction)
            self.code.of[label] = block
