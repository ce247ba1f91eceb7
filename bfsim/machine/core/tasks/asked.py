"""The latest call that a core's firmware has requested but not yielded, and the calls that machine code makes."""

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
    """The last call of one core. If the core has a `tape`, machine code makes and notes the calls that it knows."""

    ask: Callable[..., Work]
    """Makes a call of a kernel with its arguments, through `other` if machine code does not know it."""
    go_on: Callable[[Generator[Any, Any, Any], object], Any]
    """Resumes a generator until it ends, or yields something other than a call that can be noted without Python."""

    def __init__(
        self, calls: CallCache, tape: Tape | None, turn: NDArray[np.int64], other: Callable[..., Work]
    ) -> None:
        """`turn` is the core's, in which handed-over buffers are its own. `other` makes calls that machine code does not know."""
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
        """Let machine code make this call from now on, if it can."""
        if self._tape and self._tape.takes_calls and call.words and (call.stays_in_l1 or call.is_alone):
            note = note_run if call.stays_in_l1 else note_access
            turn = int(self._turn[0]) if call.handed_over else ALWAYS
            self._ready.lay(kernel, arguments, turn, (note.address(), call.words, call.number))

    def hold(self, work: Work, call: KnownCall) -> None:
        """Note that a call was made, or is to be made, and left `work`, which must live until it is claimed."""
        self._words[LEFT], self._words[NOTE], self._words[NUMBER] = id(work), 0, call.number

    @property
    def unclaimed(self) -> KnownCall | None:
        """The call that was not yielded yet, if any."""
        return self._last if self._words[LEFT] else None

    @property
    def is_noted(self) -> bool:
        """Whether machine code has noted the call that was yielded last."""
        return bool(self._words[NOTE])

    def claim(self, item: object) -> KnownCall | None:
        """Return the call that left `item` if it was not yielded yet, and mark it as yielded."""
        if self._words[LEFT] != id(item):
            return None
        self._words[LEFT] = 0
        return self._last

    @property
    def _last(self) -> KnownCall:
        return self._made[int(self._words[NUMBER])]
