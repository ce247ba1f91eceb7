"""The devices of a firmware, with the script of the user."""

from __future__ import annotations

from pathlib import Path

from bfsim.errors import ConfigError, FirmwareError
from bfsim.loading.firmware import LoadedFirmware
from bfsim.machine.peripherals.device import Device
from bfsim.machine.peripherals.table import devices_of, makers_of


def told_devices(path: Path | None, loaded: LoadedFirmware) -> tuple[dict[str, Device], str]:
    """Return the firmware's devices, which have the script if there is one, and the digest of the script.

    Raises ConfigError if no device takes a script, or if the script cannot be read or is refused by one.
    """
    if path is None:
        return devices_of(loaded.firmware, {}), ""
    if not makers_of(loaded.firmware):
        raise ConfigError(
            f"--script must go with firmware that has a device to tell, and {loaded.name} has none"
        )
    from bfsim.running.device_script import read_script  # few runs have one

    script, digest = read_script(path)
    try:
        return devices_of(loaded.firmware, script), digest
    except FirmwareError as error:
        raise ConfigError(f"{path}: {error}") from error
