"""The main loop of one core: the process that plays it."""

from __future__ import annotations

from collections.abc import Generator

from bfsim.errors import FirmwareError, is_failure
from bfsim.machine.core.core import Core
from bfsim.machine.core.parts import Parts
from bfsim.machine.core.waits import Wait
from bfsim.machine.firmware_lines import place_of
from bfsim.machine.program import Main


class MainLoop:
    """The function `main` at work on a core. `is_done` says whether it has ended."""

    def __init__(self, parts: Parts, core: Core, main: Main) -> None:
        self.pictures = parts.pictures
        self.is_done = False
        self.main = main
        self._parts = parts
        self._core = core

    def play(self) -> Wait:
        """Run the main loop: the process of this core."""
        tasks = self._parts.tasks
        try:
            task = self.main(self._core)
        except BaseException as error:
            if not is_failure(error):
                raise
            raise tasks.told(error, self.main) from error
        if not isinstance(task, Generator):
            raise FirmwareError(
                f"core {self._core.name}: the main loop must be a generator function, which has a `yield` in it: it waits with "
                f"`yield from core.next_frame()`, and runs kernels with `yield core.run(...)` ({place_of(self.main)})"
            )
        yield from tasks.perform(task)
        yield from self._parts.progress.sync()
        self.pictures.close()
        self.is_done = True

    def describe_wait(self) -> str:
        """Say what the core waits for, and where in the firmware."""
        return f"core {self._core.name} has ended" if self.is_done else self._parts.tasks.describe_wait()

    @property
    def forgotten_wait(self) -> str:
        """The wait that the main loop has never begun, in words, empty if none."""
        return self._parts.progress.waits.forgotten()
