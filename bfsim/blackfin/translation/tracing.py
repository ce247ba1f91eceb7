"""Reports of each access of object code to memory: who gets them, and what they say.

A report goes through a block of 64-bit words (`block_of`), whose address is in TRACE of the state. The block says which
addresses are followed, and what stands for them outside. An access elsewhere, such as to the stack, is not reported:
code first tests whether it is between the lowest and the highest address that is followed (`reports`).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from bfsim import machine_code
from bfsim.machine_code.native_code import native_code

TRACER = "bfsim_trace_object"
IR = f"""
define void @{TRACER}(ptr %block, i64 %address, i64 %access, i64 %stamp, i64 %site) {{
  %state.at = getelementptr i64, ptr %block, i64 3
  %state = load ptr, ptr %state.at
  %count.at = getelementptr i64, ptr %block, i64 4
  %count = load i64, ptr %count.at
  %ranges = getelementptr i64, ptr %block, i64 5
  br label %head
head:
  %number = phi i64 [ 0, %0 ], [ %number.next, %next ]
  %more = icmp ult i64 %number, %count
  br i1 %more, label %look, label %done
look:
  %first.word = mul i64 %number, 4
  %first.at = getelementptr i64, ptr %ranges, i64 %first.word
  %first = load i64, ptr %first.at
  %nbytes.at = getelementptr i64, ptr %first.at, i64 1
  %nbytes = load i64, ptr %nbytes.at
  %offset = sub i64 %address, %first
  %within = icmp ult i64 %offset, %nbytes
  br i1 %within, label %report, label %next
next:
  %number.next = add i64 %number, 1
  br label %head
report:
  %outside.at = getelementptr i64, ptr %first.at, i64 2
  %outside = load i64, ptr %outside.at
  %place = add i64 %outside, %offset
  %more.sites.at = getelementptr i64, ptr %first.at, i64 3
  %more.sites = load i64, ptr %more.sites.at
  %whole.site = add i64 %site, %more.sites
  %function = load ptr, ptr %state
  tail call void %function(ptr %state, i64 %place, i64 %access, i64 %stamp, i64 %whole.site)
  br label %done
done:
  ret void
}}
"""


@dataclass(frozen=True)
class Tracing:
    """How accesses are told apart: by `site_of`, given the addresses of a block and of an instruction in it.

    A report has the bytes of an access, and `write` more if it writes.
    """

    site_of: Callable[[int, int], int]
    write: int


class Followed(NamedTuple):
    """Memory that is followed: its first address, its bytes, its first address outside, and what is added to a site."""

    address: int
    nbytes: int
    outside: int
    site: int


def block_of(state: int, followed: Sequence[Followed]) -> Any:
    """Return the block for reports to `state`, an address whose first word is that of `function(state, place, access, stamp, site)`."""
    lowest = min((each.address for each in followed), default=0)
    span = max((each.address + each.nbytes - lowest for each in followed), default=0)
    words = [_tracer(), lowest, span, state, len(followed), *(word for each in followed for word in each)]
    return (ctypes.c_int64 * len(words))(*words)


@cache
def _tracer() -> int:
    machine_code.add(native_code(IR))
    return machine_code.address_of(TRACER)
