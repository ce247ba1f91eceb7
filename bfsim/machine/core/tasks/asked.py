"""The call that a core's firmware has asked for last and has not yielded yet, and those that machine code makes."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.kernel import Kernel, Work
from bfsim.machine.bus.tape import Tape, note_access, note_run
from bfsim.machine.calls.call_cache import CallCache, KnownCall
from bfsim.machine.calls.ready_calls import ALWAYS, find_call
from bfsim.machine_code.asking import ASKED, LEFT, NOTE, NUMBER, Found, asking
from bfsim.machine_code.going_on import Noted, going_on


class Asked:
    """The last call of one core. Machine code makes and notes those that are known to it if the core has a `tape`."""

    ask: Callable[..., Work]
    """Makes a call, of a kernel and its arguments, or has it made by what makes those that machine code does not know."""
    go_on: Callable[[Generator[Any, Any, Any], object], Any]
    """Goes on with a generator until it yields what is no call to be noted without Python, or ends."""

    def __init__(
        self, calls: CallCache, tape: Tape | None, turn: NDArray[np.int64], other: Callable[..., Work]
    ) -> None:
        """`turn`: the core's, which buffers that are handed over are its own in. `other` makes the other calls."""
        words = np.zeros(ASKED, np.int64)
        self._words: Any = words.data
        at = words.ctypes.data
        self._made = calls.made
        self._ready = calls.ready
        self._tape = tape
        self._turn = turn
        self.ask, self.go_on = other, going_on(at, tape.calls if tape else Noted(0, 0, at))
        if tape:
            found = Found(find_call.address(), calls.ready.at, turn.ctypes.data, tape.takes_calls_at)
            self.ask = asking(at, found, other)

    def know(self, call: KnownCall, kernel: Kernel, arguments: Sequence[Any]) -> None:
        """Let machine code make a call from now on, if it can."""
        if self._tape and self._tape.takes_calls and call.words and (call.stays_in_l1 or call.is_alone):
            note = note_run if call.stays_in_l1 else note_access
            turn = int(self._turn[0]) if call.handed_over else ALWAYS
            self._ready.lay(kernel, arguments, turn, (note.address(), call.words, call.number))

    def hold(self, work: Work, call: KnownCall) -> None:
        """Note that a call was made, or is to be, and left something, which must live until it is claimed."""
        self._words[LEFT], self._words[NOTE], self._words[NUMBER] = id(work), 0, call.number

    @property
    def unclaimed(self) -> KnownCall | None:
        """The call that was not yielded yet, if there is one."""
        return self._last if self._words[LEFT] else None

    @property
    def is_noted(self) -> bool:
        """Whether machine code has noted the call that was yielded last."""
        return bool(self._words[NOTE])

    def claim(self, item: object) -> KnownCall | None:
        """Return the call that has left `item`, if that is the one that was not yielded yet; from now on it is."""
        if self._words[LEFT] != id(item):
            return None
        self._words[LEFT] = 0
        return self._last

    @property
    def _last(self) -> KnownCall:
        return self._made[int(self._words[NUMBER])]
