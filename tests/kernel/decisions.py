"""Kernels that decide by chance: chains of tests of a variable, sets of numbers, states that are set in the arms, in a loop that may be left."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

VARIABLES = ("s", "t", "c", "k")
NUMBERS = range(-8, 70)  # on both sides of 0, and more than a word has bits
DEEPEST = 3
HEAD = """
def f(a: u8[:], o: i32[:], n: i32) -> i32:
    s = 0
    t = 0
    k = 0
    c = 0
    for i in range(n):
        c = {}"""
TAIL = "    return s + 64 * t + 4096 * k"


@dataclass
class Decisions:
    """Writes kernels; each is another one."""

    random: Random
    rows: list[str] = field(default_factory=list)

    def kernel(self) -> str:
        """Return the text of a kernel `f` of bytes, words and a number."""
        value = self.random.choice(("a[i]", "a[i] & 7", "a[i] & 15", "a[i] % 11", "(a[i] & 15) - 6"))
        self.rows = [HEAD.format(value)]
        for _ in range(self.random.randint(1, 3)):
            self._body(2, 0)
        return "\n".join((*self.rows, TAIL))

    def _add(self, indent: int, text: str) -> None:
        self.rows.append("    " * indent + text)

    def _variable(self) -> str:
        return self.random.choice(VARIABLES)

    def _value(self, depth: int = 0) -> str:
        kind = self.random.random()
        if kind < 0.3:
            return str(self.random.randint(-3, 60))
        if kind < 0.7 or depth == 2:
            return self._variable()
        return f"({self._value(depth + 1)} {self.random.choice('+-&^|')} {self._value(depth + 1)})"

    def _condition(self) -> str:
        kind, name = self.random.random(), self._variable()
        numbers = self.random.sample(NUMBERS, self.random.randint(2, 6))
        if kind < 0.35:
            return f"{name} {self.random.choice(('==', '!='))} {self.random.randint(-3, 12)}"
        if kind < 0.6:
            return " or ".join(f"{name} == {each}" for each in numbers)
        if kind < 0.75:
            return " and ".join(f"{name} != {each}" for each in numbers)
        return f"{name} {self.random.choice(('<', '>', '<=', '>='))} {self._value()}"

    def _body(self, indent: int, depth: int) -> None:
        for _ in range(self.random.randint(1, 3)):
            kind = self.random.random()
            if kind < 0.3 and depth < DEEPEST:
                self._chain(indent, depth)
            elif kind < 0.5 and depth < DEEPEST:
                self._add(indent, f"if {self._condition()}:")
                self._body(indent + 1, depth + 1)
                if self.random.random() < 0.5:
                    self._add(indent, "else:")
                    self._body(indent + 1, depth + 1)
            elif kind < 0.55 and depth:
                self._add(indent, self.random.choice(("continue", "break")))
                return
            elif kind < 0.62:
                self._add(indent, f"o[{self._variable()} & 127] = {self._value()}")
            elif kind < 0.7:
                one, other = self.random.randint(0, 9), self.random.randint(0, 9)
                self._add(indent, f"{self._variable()} = {one} if {self._condition()} else {other}")
            else:
                self._add(indent, f"{self._variable()} = ({self._value()}) & 63")

    def _chain(self, indent: int, depth: int) -> None:
        name, count = self._variable(), self.random.randint(2, 9)
        least = self.random.choice((0, 0, 1, -4))
        numbers = self.random.sample(range(least, least + self.random.choice((count, 12, 40))), count)
        for place, number in enumerate(numbers):
            test = f"{name} == {number}"
            if self.random.random() < 0.2:
                test += f" or {name} == {self.random.randint(41, 60)}"
            self._add(indent, f"{'elif' if place else 'if'} {test}:")
            if self.random.random() < 0.6:
                self._add(indent + 1, f"{self._variable()} = {self.random.randint(0, 9)}")
            else:
                self._body(indent + 1, depth + 1)
        if self.random.random() < 0.6:
            self._add(indent, "else:")
            self._body(indent + 1, depth + 2)
