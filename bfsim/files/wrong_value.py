"""What is wrong with a value that pydantic refuses, in bfsim's words."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import TYPE_CHECKING

from bfsim.errors import cut, shown

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails


def key_of(place: Iterable[int | str]) -> str:
    """Return the place of a value by its keys and numbers."""
    return cut(".".join(map(str, place)))


def wrong_value(found: ErrorDetails) -> str:
    """Return what a value must be and is not. A list is called a list, whatever Python type it becomes."""
    if found["type"] == "missing":
        return "must be there"
    must_be = re.sub(r"^\w+ should ", "must ", found["msg"]).partition(" after validation")[0]
    must_be = re.sub(r" or (an )?instance of \w+$", "", must_be).replace("tuple", "list")
    if "Sequence" in must_be:
        must_be = "must be a valid list"
    return f"{must_be}, not {shown(found['input'])}"
