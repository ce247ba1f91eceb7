"""Why native code of the Blackfin is left."""

from __future__ import annotations

from enum import IntEnum


class Event(IntEnum):
    """Why native code was left."""

    UNKNOWN_TARGET = 0
    """PC is an address where no block of the code starts, such as the return address of its caller."""
    ILLEGAL = 1
    """There is no instruction at PC."""
    EXCEPTION = 2
    """EXCPT: its number is ARGUMENT."""
    OUTPUT = 3
    """OUTC: the character is ARGUMENT."""
    HALT = 4
    ABORT = 5
    ASSERTION = 6
    """DBGA found another value than it expects, ARGUMENT."""
    SYSTEM = 7
    """An instruction of the system that is not simulated: RTI, RAISE, IDLE ..."""
    FUEL = 8
    """As many blocks were run as were allowed."""
    FAULT = 9
    """An access to an address where there is no memory. Registers are lost."""
    MISALIGNED = 10
    """An instruction at PC accesses an address that is no multiple of its size, in code whose accesses must be aligned."""
    NOT_KEPT = 11
    """Not from the code itself: it has returned, but has changed registers of its caller."""


ENDS = {
    Event.ILLEGAL: (0, "no instruction of the Blackfin, as behind a function that does not end with RTS"),
    Event.EXCEPTION: (
        2,
        "an exception (EXCPT), which nothing handles; GCC has one where C does not say what happens, as where it sees a division by 0",
    ),
    Event.SYSTEM: (
        2,
        "an instruction for the system, such as IDLE, RAISE or RTI, of which a kernel has none",
    ),
    Event.ASSERTION: (4, "an assertion for simulators (DBGA, DBGAL or DBGAH) that does not hold"),
} | dict.fromkeys(
    (Event.OUTPUT, Event.HALT, Event.ABORT),
    (2, "an instruction for simulators (OUTC, HLT or ABORT), which the Blackfin has not"),
)
"""Instructions at which code ends: how many bytes PC is past one, and what it is."""
