"""Records that are made when somebody asks for them."""

from __future__ import annotations

import pickle

from bfsim.trace import Later


def test_they_are_made_once_and_only_for_who_asks() -> None:
    """And are a tuple to everybody."""
    made = list[str]()

    def make() -> list[int]:
        made.append("now")
        return [1, 2, 3]

    later = Later(make)
    assert not made
    assert (len(later), later[0], later[1:], list(later)) == (3, 1, (2, 3), [1, 2, 3])
    assert later == (1, 2, 3) == later
    assert later != (1, 2)
    assert repr(later) == "(1, 2, 3)"
    assert made == ["now"]


def test_between_processes_they_are_a_tuple() -> None:
    """What makes them stays where it is."""
    assert pickle.loads(pickle.dumps(Later(lambda: [1, 2]))) == (1, 2)
