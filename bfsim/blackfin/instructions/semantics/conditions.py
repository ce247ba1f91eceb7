"""The condition bit CC."""

from __future__ import annotations

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.registers import FLAGS
from bfsim.blackfin.instructions.value import Value


def compare(fx: Effects, x: str, y: str | int, relation: str, flags: int) -> None:
    """Compare registers; pointers leave the flags alone."""
    left = fx.read(x)
    right = fx.read(y) if isinstance(y, str) else fx.constant(y)
    fx.write("CC", _related(left, right, relation))
    if flags:
        less = left.below(right) if relation.startswith("below") else left < right
        fx.set_flags(AZ=left.equals(right), AN=less, AC0=right.below_or_equal(left))


def compare_accumulators(fx: Effects, relation: str) -> None:
    left, right = fx.read("A0"), fx.read("A1")
    fx.write("CC", _related(left, right, relation))
    fx.set_flags(AZ=left.equals(right), AN=left < right, AC0=right.below_or_equal(left))


def _related(left: Value, right: Value, relation: str) -> Value:
    return {
        "equal": left.equals,
        "less": left.__lt__,
        "less_or_equal": left.__le__,
        "below": left.below,
        "below_or_equal": left.below_or_equal,
    }[relation](right)


def register_from_cc(fx: Effects, d: str) -> None:
    fx.write(d, fx.read("CC").zero_extended())


def cc_from_register(fx: Effects, s: str) -> None:
    fx.write("CC", fx.read(s).differs(0))


def invert_cc(fx: Effects) -> None:
    fx.write("CC", ~fx.read("CC"))


def cc_from_status(fx: Effects, operator: str, place: int) -> None:
    fx.write("CC", _combined(fx.read("CC"), _status_bit(fx, place), operator))


def cc_to_status(fx: Effects, operator: str, place: int) -> None:
    """Write a flag; of a flag and its copy, only the one that is named."""
    new = _combined(_status_bit(fx, place), fx.read("CC"), operator)
    others = fx.read("ASTAT") & ~(1 << place)
    fx.write("ASTAT", others | new.zero_extended().shift_left(place))


def _status_bit(fx: Effects, place: int) -> Value:
    for flag, at in FLAGS.items():
        if at == place:
            return fx.read(flag)
    return fx.read("ASTAT_UNUSED").shift_right(place).low(1)


def _combined(old: Value, new: Value, operator: str) -> Value:
    return {"": lambda: new, "|": lambda: old | new, "&": lambda: old & new, "^": lambda: old ^ new}[
        operator
    ]()


def test_bit(fx: Effects, d: str, b: int, when: int) -> None:
    fx.write("CC", fx.read(d).shift_right(b).low(1).equals(when))
