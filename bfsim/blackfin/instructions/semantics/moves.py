"""Register moves, conditional moves, and the stack."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects


def move(fx: Effects, d: str, s: str) -> None:
    fx.write(d, fx.read(s))


def move_if(fx: Effects, d: str, s: str, when: int) -> None:
    fx.write(d, fx.read("CC").equals(when).choose(fx.read(s), fx.read(d)))


def push(fx: Effects, g: str) -> None:
    top = fx.read("SP") - 4
    fx.store(top, fx.read(g))
    fx.write("SP", top)


def pop(fx: Effects, g: str) -> None:
    top = fx.read("SP")
    fx.write(g, fx.load(top, 4))
    fx.write("SP", top + 4)


def push_multiple(fx: Effects, d: int = 8, p: int = 6) -> None:
    top = fx.read("SP")
    for each in _several(d, p):
        top -= 4
        fx.store(top, fx.read(each))
    fx.write("SP", top)


def pop_multiple(fx: Effects, d: int = 8, p: int = 6) -> None:
    top = fx.read("SP")
    for each in reversed(_several(d, p)):
        fx.write(each, fx.load(top, 4))
        top += 4
    fx.write("SP", top)


def _several(d: int, p: int) -> list[str]:
    return [*(f"R{number}" for number in range(d, 8)), *(f"P{number}" for number in range(p, 6))]
