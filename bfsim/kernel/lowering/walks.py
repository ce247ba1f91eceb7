"""Values that advance by the same amount with every turn of a loop (scalar evolution, in its simplest form).

An address that does is a pointer which a compiler steps along instead of computing it: for nothing, where a
post-increment does it, or with one addition a turn.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.kernel.ir_text import PHI_ARM
from bfsim.kernel.loops import Flow, Loop, pointee_nbytes
from bfsim.kernel.lowering.evaluated import evaluated_turns
from bfsim.kernel.lowering.places import Places

DEEPEST = 12  # operations that a form looks through


@dataclass(frozen=True, slots=True)
class Form:
    """A sum: `constant` plus each named value times its factor."""

    terms: tuple[tuple[str, int], ...] = ()
    constant: int = 0

    def plus(self, other: Form, factor: int = 1) -> Form:
        """Return this form plus `factor` times the other."""
        terms = dict(self.terms)
        for name, times in other.terms:
            terms[name] = terms.get(name, 0) + factor * times
        kept = tuple(sorted((name, times) for name, times in terms.items() if times))
        return Form(kept, self.constant + factor * other.constant)


@dataclass(frozen=True, slots=True)
class Advance:
    """What a value gains per turn: `constant`, or an amount that is known only when the loop starts."""

    constant: int = 0
    symbolic: bool = False

    @property
    def moves(self) -> bool:
        """Whether it gains anything."""
        return self.symbolic or self.constant != 0


class Walks:
    """Forms and advances of the values of one routine."""

    def __init__(self, flow: Flow, places: Places) -> None:
        self.flow, self.places = flow, places

    def form(self, value: str, depth: int = DEEPEST) -> Form:
        """Return `value` as a sum; an address in bytes."""
        if value.lstrip("-").isdigit():
            return Form(constant=int(value))
        each = self.flow.instruction(value)
        alone = Form(((value, 1),))
        if each is None or depth == 0:
            return alone
        last = each.operands[-1] if each.operands else ""
        number = int(last) if last.lstrip("-").isdigit() else None
        match each.opcode:
            case "getelementptr":
                base, index = self.form(each.operands[0], depth - 1), self.form(last, depth - 1)
                return base.plus(index, pointee_nbytes(each))
            case "add":
                return self.form(each.operands[0], depth - 1).plus(self.form(last, depth - 1))
            case "or" if " disjoint " in each.text:
                return self.form(each.operands[0], depth - 1).plus(self.form(last, depth - 1))
            case "sub":
                return self.form(each.operands[0], depth - 1).plus(self.form(last, depth - 1), -1)
            case "shl" if number is not None:
                return Form().plus(self.form(each.operands[0], depth - 1), 1 << number)
            case "mul" if number is not None:
                return Form().plus(self.form(each.operands[0], depth - 1), number)
        return alone

    def advance(self, value: str, loop: Loop) -> Advance | None:
        """Return what `value` gains per turn of `loop`; None if that changes from turn to turn."""
        form = self.form(value)
        total, symbolic = 0, False
        for name, times in form.terms:
            gain = self._of_term(name, loop)
            if gain is None:
                return None
            total, symbolic = total + times * gain.constant, symbolic or gain.symbolic
        return Advance(total, symbolic)

    def _of_term(self, name: str, loop: Loop) -> Advance | None:
        if self.places.is_invariant(name, loop):
            return Advance()
        each = self.flow.instruction(name)
        assert each is not None
        if each.opcode == "phi" and self.flow.defined[name][0] == loop.header:
            return self._of_counter(name, loop)
        if each.opcode == "mul":
            left, right = (self.advance(operand, loop) for operand in each.operands)
            if left and right and not (left.moves and right.moves) and not (left.symbolic or right.symbolic):
                return Advance(symbolic=True)
        return None

    def _of_counter(self, phi: str, loop: Loop) -> Advance | None:
        gain = self.gain(phi, loop)
        if gain is None:
            return None
        if not gain.terms:
            return Advance(gain.constant)
        fixed = all(self.places.is_invariant(name, loop) for name, _ in gain.terms)
        return Advance(symbolic=True) if fixed else None

    def gain(self, phi: str, loop: Loop) -> Form | None:
        """Return by how much a phi of the header of `loop` differs from its value a turn before."""
        instruction = self.flow.instruction(phi)
        assert instruction is not None
        updates = {arm for arm, source in PHI_ARM.findall(instruction.text) if source[1:] in loop.blocks}
        if len(updates) != 1:
            return None
        form = self.form(updates.pop())
        if dict(form.terms).get(phi) != 1:
            return None
        return form.plus(Form(((phi, 1),)), -1)

    def is_counted(self, loop: Loop) -> bool:
        """Whether the number of turns is known when the loop starts: its last test compares a stepping value."""
        test = self.exit_test(loop)
        return test is not None and (
            self._counts(test, loop) or evaluated_turns(self.flow, loop, test) is not None
        )

    def _counts(self, test: str, loop: Loop) -> bool:
        each = self.flow.instruction(test)
        if each is None or each.opcode != "icmp":
            return False
        gains = [self.advance(operand, loop) for operand in each.operands[:2]]
        if None in gains:
            return False
        moving = [gain for gain in gains if gain is not None and gain.moves]
        return len(moving) == 1 and not moving[0].symbolic

    def turns(self, loop: Loop) -> int | None:
        """How often `loop` turns, where constants say so."""
        test = self.flow.instruction(self.exit_test(loop) or "")
        if test is None or test.opcode != "icmp" or not test.operands[1].lstrip("-").isdigit():
            return None
        gain = self.advance(test.operands[0], loop)
        start = self._start(test.operands[0], loop)
        if gain is None or start is None or not gain.constant or gain.symbolic:
            return evaluated_turns(self.flow, loop, test.result or "")
        return max(0, (int(test.operands[1]) - start) // gain.constant) + 1

    def _start(self, value: str, loop: Loop) -> int | None:
        """What a form of one counter is at its first turn."""
        form, entering = self.form(value), self.flow.entering(loop)
        if len(form.terms) != 1:
            return None
        name, times = form.terms[0]
        each = self.flow.instruction(name)
        if each is None or each.opcode != "phi":
            return None
        first = next((arm for arm, source in PHI_ARM.findall(each.text) if source[1:] == entering), "")
        return int(first) * times + form.constant if first.lstrip("-").isdigit() else None

    def starts_fixed(self, loop: Loop) -> bool:
        """Whether every counter of `loop` starts at a constant."""
        entering = self.flow.entering(loop)
        counters = [each for each in self.flow.blocks[loop.header].instructions if each.opcode == "phi"]
        starts = [
            value
            for each in counters
            if self._of_counter(each.result or "", loop) is not None
            for value, source in PHI_ARM.findall(each.text)
            if source[1:] == entering
        ]
        return all(value.lstrip("-").isdigit() for value in starts)

    def exit_test(self, loop: Loop) -> str | None:
        """Return the condition that ends `loop`, if its last block has it; of two joined ones, the one that counts."""
        ending = self.flow.blocks[self.flow.ending(loop)]
        terminator, leaves = ending.terminator, set(ending.successors) - loop.blocks
        if not leaves or terminator.opcode != "br":
            return None
        test = self.flow.instruction(terminator.operands[0])
        if test is not None and test.opcode in ("select", "and", "or"):
            return next((each for each in test.operands if self._counts(each, loop)), test.result)
        return terminator.operands[0]
