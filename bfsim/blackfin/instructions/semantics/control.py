"""Control flow."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects


def return_(fx: Effects) -> None:
    fx.jump_to(fx.read("RETS"))


def jump(fx: Effects, t: int) -> None:
    fx.jump(t)


def jump_to(fx: Effects, p: str) -> None:
    fx.jump_to(fx.read(p))


def jump_relative(fx: Effects, p: str) -> None:
    fx.jump_to(fx.read(p) + fx.address)


def call(fx: Effects, t: int) -> None:
    _come_back(fx)
    fx.jump(t)


def call_to(fx: Effects, p: str) -> None:
    _come_back(fx)
    fx.jump_to(fx.read(p))


def call_relative(fx: Effects, p: str) -> None:
    _come_back(fx)
    fx.jump_to(fx.read(p) + fx.address)


def _come_back(fx: Effects) -> None:
    fx.write("RETS", fx.following())


def branch(fx: Effects, t: int, when: int) -> None:
    fx.branch(fx.read("CC").equals(when), t)


branch_predicted = branch
"""It differs in time only."""


def loop_setup(fx: Effects, c: int, s: int, e: int, p: str | None = None, halved: int = 0) -> None:
    fx.write(f"LT{c}", s)
    fx.write(f"LB{c}", e)
    if p is not None:
        fx.write(f"LC{c}", fx.read(p).shift_right(halved))


def link(fx: Effects, n: int) -> None:
    top = fx.read("SP")
    fx.store(top - 4, fx.read("RETS"))
    fx.store(top - 8, fx.read("FP"))
    fx.write("FP", top - 8)
    fx.write("SP", top - 8 - n)


def unlink(fx: Effects) -> None:
    frame = fx.read("FP")
    fx.write("FP", fx.load(frame, 4))
    fx.write("RETS", fx.load(frame + 4, 4))
    fx.write("SP", frame + 8)
