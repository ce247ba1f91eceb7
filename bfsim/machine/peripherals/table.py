"""The peripherals of a board in one table. Everything else about them is derived from it."""

from __future__ import annotations

from collections.abc import Mapping

from bfsim.errors import FirmwareError, shown
from bfsim.machine.peripherals.device import LARGEST_MESSAGE_BYTES, Device, MakeDevice, Script, device_at_work
from bfsim.machine.peripherals.peripheral import Peripheral
from bfsim.machine.peripherals.spi import Spi
from bfsim.machine.peripherals.uart import Uart
from bfsim.machine.peripherals.wire import Surroundings
from bfsim.machine.program import Firmware

PERIPHERALS = (Spi, Uart)

OUTSIDE_NBYTES = sum(each.wires for each in PERIPHERALS) * LARGEST_MESSAGE_BYTES
"""Room for the messages of all peripherals on their way."""


def wired(around: Surroundings, devices: Mapping[str, Device], outside: int) -> dict[str, Peripheral]:
    """Return the peripherals of a board by name, with `devices` at their other ends. `outside` is where the room above begins."""
    made: dict[str, Peripheral] = {}
    for kind in PERIPHERALS:
        made[kind.name] = kind(
            around, devices[kind.name] if kind.name in devices else kind.device_kind(), outside
        )
        outside += kind.wires * LARGEST_MESSAGE_BYTES
    return made


def makers_of(firmware: Firmware) -> dict[str, MakeDevice]:
    """Return the functions that make the firmware's devices, by the names of their peripherals."""
    fields = {each.name: getattr(firmware, each.name.lower()) for each in PERIPHERALS}
    return {name: make for name, make in fields.items() if make is not None}


def devices_of(firmware: Firmware, script: Script) -> dict[str, Device]:
    """Return a new device, following the script, for each peripheral for which the firmware provides one."""
    kinds = {each.name: each.device_kind for each in PERIPHERALS}
    devices = {}
    for name, make in makers_of(firmware).items():
        with device_at_work(name):
            devices[name] = make(script)
        if not isinstance(devices[name], kinds[name]):
            raise FirmwareError(
                f"{name.lower()} must make a bfsim.api.{kinds[name].__name__}, not {shown(devices[name])}"
            )
    return devices
