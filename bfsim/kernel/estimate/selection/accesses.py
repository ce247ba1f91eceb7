"""Loads and stores, and the pointers that they go through: those that walk along, and those computed where they are used."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.estimate.selection.row_pointers import RowPointers
from bfsim.kernel.ir.control_flow import EITHER, pointee_nbytes
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
LOADS = {8: Op.LOAD8, 16: Op.LOAD16, 32: Op.LOAD32}
STORES = {8: Op.STORE8, 16: Op.STORE16, 32: Op.STORE32}


class Accesses:
    """Loads, stores and addresses."""

    def __init__(self, emitter: Emitter) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context, self.flow = emitter.context, emitter.context.flow
        self.rows = RowPointers(emitter)
        self.beside: dict[str, list[str]] = {}
        """Blocks in which the pointer of a variable is computed from its neighbour's."""
        self.stepped = set[str]()
        """Pointers that have been stepped already, for an access to where they are next."""
        self.ahead: dict[str, str] = {}
        """Pointers whose next value is computed before the end of an iteration, for one side of a test wants it, and its name there."""

    def load(self, each: Instruction) -> None:
        bank = ANY if each.bits == 32 else DATA
        address, nbytes = (self._address(each), POINTER), self._access_bytes(each)
        self.append(LOADS[each.bits], each, each.result, bank, address, nbytes=nbytes, access=each)
        if self.context.narrow.extended_apart(each):
            self.append(Op.EXTEND, each, f"{each.result}.wide", DATA, (each.result or "", DATA))
            if self.context.narrow.extended_for_distance(each):
                self.append(Op.EXTEND, each, None, DATA, (each.result or "", DATA))
        elif self.context.narrow.extended_late(each):
            self.append(Op.EXTEND, each, each.result, DATA, (each.result or "", DATA))

    def store(self, each: Instruction) -> None:
        bank = ANY if each.bits == 32 else DATA
        value, address = (each.operands[0], bank), (self._address(each), POINTER)
        self.append(
            STORES[each.bits], each, None, DATA, value, address, nbytes=self._access_bytes(each), access=each
        )

    def _access_bytes(self, each: Instruction) -> int | None:
        """The long form, for an offset that the short one has no room for: bytes have none there, others a few of their own width, upwards [PRM]."""
        nbytes = each.bits // operations.BYTE_BITS
        in_short = range(0, operations.SHORT_OFFSETS * nbytes if nbytes > 1 else 1, nbytes)
        return None if self._offset(each) in in_short else operations.LONG_FORM_BYTES

    def _offset(self, each: Instruction) -> int:
        """By how many bytes an access is beyond its pointer."""
        variable = self.context.induction_variables.of.get(id(each))
        if variable is not None:
            return variable.distance_of(each)
        pointer = self.flow.instruction(each.operands[-1])
        if pointer is None or pointer.opcode != "getelementptr" or not is_number(pointer.operands[-1]):
            return 0
        return int(pointer.operands[-1]) * pointee_nbytes(pointer)

    def _address(self, each: Instruction) -> str:
        """Return the pointer that an access uses: one that walks along, or one that was computed."""
        variable = self.context.induction_variables.of.get(id(each))
        if variable is not None and variable.neighbour is not None:
            return self._beside(variable, variable.neighbour.name, each)
        return variable.name if variable else self.context.base(each.operands[-1])

    def _beside(self, variable: InductionVariable, neighbour: str, each: Instruction) -> str:
        """Compute a pointer from another one, once on each way; what is subtracted goes through the data registers."""
        if variable.follows and self.emitter.label == variable.loop.latch:
            if neighbour not in self.stepped:
                self.stepped.add(neighbour)
                self._step(variable.neighbour or variable)
            return neighbour
        known = self.beside.setdefault(variable.name, [])
        for label in known:
            if label in self.flow.dominators[self.emitter.label]:
                return f"{variable.name}.{label}"
        known.append(self.emitter.label)
        address = f"{variable.name}.{self.emitter.label}"
        if len(variable.distance) == 1 and variable.distance[0][1] != -1:
            self.append(
                Op.ALU, each, address, POINTER, (neighbour, POINTER), (self._scaled(variable, each), POINTER)
            )
        elif self.context.induction_variables.is_steady(variable):
            self.append(
                Op.ALU,
                each,
                address,
                POINTER,
                (neighbour, POINTER),
                (self._prepared(variable, each), POINTER),
            )
        else:
            for name, _ in variable.distance:
                self.append(Op.ALU, each, address, DATA, (neighbour, DATA), (name, DATA))
                neighbour = address
        return address

    def _scaled(self, variable: InductionVariable, each: Instruction) -> str:
        (name, times), *_ = variable.distance
        if times == 1:
            return name
        distance, entering = f"{variable.name}.distance", self.flow.entering(variable.loop)
        if not any(instruction.result == distance for instruction in self.emitter.code.of[entering]):
            self.emitter.code.add(
                entering,
                MachineInstruction(Op.SHIFT, each.line, distance, DATA, ((self.context.name(name), DATA),)),
            )
        return distance

    def _prepared(self, variable: InductionVariable, each: Instruction) -> str:
        """A distance of several terms, which is added up before the loop."""
        distance, entering = f"{variable.name}.distance", self.flow.entering(variable.loop)
        if not any(instruction.result == distance for instruction in self.emitter.code.of[entering]):
            for name, times in variable.distance:
                op = Op.ALU if abs(times) == 1 else Op.SHIFT
                uses = ((self.context.name(name), DATA),)
                self.emitter.code.add(entering, MachineInstruction(op, each.line, distance, DATA, uses))
        return distance

    def element(self, each: Instruction) -> None:
        """An address that does not walk: base plus scaled index; constant offsets belong to the access."""
        base, index = each.operands[0], each.operands[-1]
        if not index.startswith("%"):
            self._field(each)
            return
        walking = self._walking(each)
        if walking is not None:
            self.ahead[walking.name] = each.result or ""
            self.append(Op.ALU, each, each.result, POINTER, (walking.name, POINTER))
            return
        op = Op.ALU if pointee_nbytes(each) == 1 else Op.ADD_SHIFT
        if op is Op.ADD_SHIFT and self._is_masked_byte(index):
            # the distance is a product of half-words [convert_mult_to_widen in tree-ssa-math-opts.cc]
            self.append(Op.EXTEND, each, f"{each.result}.index", DATA, (index, DATA))
            index = f"{each.result}.index"
        if op is Op.ADD_SHIFT and (scaled := self._scaled_index(each)):
            op, index = Op.ALU, scaled
        self.append(op, each, each.result, POINTER, (self.context.base(base), POINTER), (index, POINTER))

    def _is_masked_byte(self, index: str) -> bool:
        """Whether an index is what a mask leaves of a byte, extended behind the mask."""
        extension = self.flow.instruction(index)
        if extension is None or extension.opcode != "zext" or not self.context.is_extended_late(extension):
            return False
        made = self.flow.instruction(extension.operands[0])
        return made is not None and made.opcode == "and"

    def _scaled_index(self, each: Instruction) -> str:
        """Compute an index in bytes where that of the next element, which one side of a test chooses, is made of it; its name, or none.

        [gimple-ssa-strength-reduction.cc: a product of a sum is one of what it is the sum of, and a number]
        """
        index = each.operands[-1]
        name, made = f"{index}.bytes", self.flow.instruction(index)
        if any(self._is_next(user, each) for user in self.flow.users.get(index, ())):
            self.append(Op.SHIFT, each, name, POINTER, (index, POINTER))
            return name
        if made is not None and self._is_next(made, each):
            before = f"{made.operands[0]}.bytes"
            if any(row.result == before for rows in self.emitter.code.of.values() for row in rows):
                self.append(Op.ALU, each, name, POINTER, (before, POINTER))
                return name
        return ""

    def _is_next(self, index: Instruction, like: Instruction) -> bool:
        """Whether an index is the sum of another one and a number, and one side of a test chooses an element there, as wide as `like`."""
        return (
            index.opcode == "add"
            and is_number(index.operands[1])
            and any(
                user.opcode == "getelementptr"
                and pointee_nbytes(user) == pointee_nbytes(like)
                and self._is_chosen(user)
                for user in self.flow.users.get(index.result or "", ())
            )
        )

    def _is_chosen(self, address: Instruction) -> bool:
        """Whether one side of a test chooses an address."""
        users = self.flow.users.get(address.result or "", ())
        return any((user.result or "").endswith(EITHER) for user in users)

    def _walking(self, each: Instruction) -> InductionVariable | None:
        """The pointer whose next value is the address that one side of a test chooses [one_pre_gcse_pass in gcse.cc]."""
        if not self._is_chosen(each):
            return None
        at = self.context.evolution.affine(each.result or "")
        for variable in self.context.induction_variables.all:
            inside = variable.loop in self.flow.loops_of(self.emitter.label) and variable.steps_free
            first = self.context.evolution.affine(variable.accesses[0][1].operands[-1])
            if inside and first.terms == at.terms and at.constant == variable.increment.constant:
                return variable
        return None

    def _field(self, each: Instruction) -> None:
        """The address of a field, where that is not an offset in the access."""
        fields, name = self.context.fields, each.result or ""
        if fields is None or (name not in fields.own and name not in fields.first):
            return
        record = (self.context.base(each.operands[0]), POINTER)
        if name in fields.copies:
            self.append(Op.MOVE, each, name, POINTER, record)
        if name in fields.own:
            self.append(Op.ALU, each, name, POINTER, record)
            self.append(Op.ALU, each, name, POINTER, (name, POINTER))
        else:
            self.append(Op.ALU, each, None, POINTER, record)
            self.append(Op.ADD_SHIFT, each, None, POINTER, record)

    def counters(self, label: str) -> None:
        """Compute the counters that a pointer stands for; it has been stepped by then, so each iteration keeps what it was."""
        for each in self.context.counters.eliminated.values():
            variable = each.variable
            if label == variable.loop.header and not each.is_stepped and variable.steps_free:
                self.emitter.code.add(
                    label,
                    MachineInstruction(Op.MOVE, variable.line, None, POINTER, ((variable.name, POINTER),)),
                )
            if label in each.blocks:
                moves = each.is_compared and variable.steps_free
                bank = DATA if moves else POINTER
                start = variable.name
                if moves:
                    start = f"{each.name}.pointer"
                    move = MachineInstruction(
                        Op.MOVE, variable.line, start, DATA, ((variable.name, POINTER),)
                    )
                    self.emitter.code.add(label, move)
                terms = ((start, bank), (self.context.name(variable.root), bank))
                step = MachineInstruction(Op.ALU, variable.line, each.name, bank, terms)
                self.emitter.code.add(label, step)
                if each.sums > 1:
                    self.emitter.code.add(label, replace(step, uses=((each.name, bank),)))

    def pointers(self) -> None:
        """Set up the pointers that walk, and step those for which no post-increment does."""
        for variable in self.context.induction_variables.all:
            if variable.loop.header in self.context.memory_calls or variable.neighbour is not None:
                continue
            self._set_up(variable)
            if variable.keeps_address:
                self._step_apart(variable)
            if variable.name in self.ahead:
                self._add(variable.loop.latch, Op.MOVE, variable, variable.name, self.ahead[variable.name])
            elif not variable.steps_free and variable.name not in self.stepped:
                self._step(variable)

    def _set_up(self, variable: InductionVariable) -> None:
        """Compute where a pointer starts, before its loop."""
        entering, total = self.flow.entering(variable.loop), self.context.name(variable.root)
        if self.rows.start(variable):
            return
        if not variable.start:
            start = MachineInstruction(
                Op.MOVE, variable.line, variable.name, POINTER, ((variable.root, ANY),)
            )
            self.emitter.code.add(entering, start)
        for name, times in variable.start:
            op = Op.ALU if abs(times) == 1 else Op.ADD_SHIFT
            self._add(entering, op, variable, variable.name, total, self.context.name(name))
            total = variable.name
        if variable.offset_apart:
            self._add(entering, Op.ALU, variable, variable.name, variable.name)

    def _step(self, variable: InductionVariable) -> None:
        """Step a pointer at the end of an iteration."""
        latch, stride = variable.loop.latch, (variable.stride,) if variable.stride else ()
        self._add(latch, Op.ALU, variable, variable.name, variable.name, *stride)
        loose = (
            variable.loop.header not in self.context.counters.counted
            and len(self.flow.exits(variable.loop)) > 1
            and self._is_wanted_behind(variable)
        )
        if loose and self.context.profile.applies(Rule.POINTER_COPIES):
            # the exits see the pointer before and after its step
            self._add(latch, Op.MOVE, variable, None, variable.name)

    def _step_apart(self, variable: InductionVariable) -> None:
        """Keep the address from before the step."""
        assert variable.stepping is not None
        self._add(variable.stepping.label, Op.MOVE, variable, None, variable.name)
        self._add(variable.stepping.label, Op.ALU, variable, variable.name, variable.name)

    def _add(
        self, label: str, op: Op, variable: InductionVariable, result: str | None, *pointers: str
    ) -> None:
        """Append an operation on pointers to a block."""
        uses = tuple((each, POINTER) for each in pointers)
        self.emitter.code.add(label, MachineInstruction(op, variable.line, result, POINTER, uses))

    def _is_wanted_behind(self, variable: InductionVariable) -> bool:
        """Whether a counter that the addresses of `variable` are made of, or its next value, is wanted behind the loop."""
        loop, address = variable.loop, variable.accesses[0][1].operands[-1]
        terms = (name for name, _ in self.context.evolution.affine(address).terms)
        counters = {name for name in terms if not self.flow.is_invariant(name, loop)}
        steps = {user.result for name in counters for user in self.flow.users[name] if user.opcode == "add"}
        outside = (block for label, block in self.flow.blocks.items() if label not in loop.blocks)
        return any((counters | steps) & {*each.operands} for block in outside for each in block.instructions)
