"""Find by name what users write in Python. It is code: nothing is imported that the user did not name."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from types import ModuleType
from typing import Generic, TypeVar

from bfsim.errors import FirmwareError, cut, with_article
from bfsim.loading.importing import OwnModules
from bfsim.loading.locating import located, parted
from bfsim.loading.modules import import_own, path_of

Wanted = TypeVar("Wanted")


@dataclass(frozen=True, slots=True)
class NamedKind(Generic[Wanted]):
    """What an option takes by name: objects of one type, which users import from `module`; some are `built_in`."""

    noun: str
    option: str
    type: type[Wanted]
    module: str
    built_in: tuple[str, ...]

    @property
    def must_be(self) -> str:
        """Say which names the option takes."""
        return f"{self.option} must be one of {', '.join(self.built_in)}, FILE.py:NAME or PACKAGE:NAME"

    def advice(self, attribute: str) -> str:
        """Say how the built-in ones are written, in case the user meant one."""
        *names, last = self.built_in
        if attribute in self.built_in:
            return f"; the built-in {self.noun} is written {attribute}"
        return f"; built in are {', '.join(names)} and {last}"


@dataclass(frozen=True, slots=True)
class Loaded(Generic[Wanted]):
    """What was found under a name, the name as MODULE:NAME, its module, and all of its own modules."""

    name: str
    value: Wanted
    module: ModuleType
    own: OwnModules


def load_named(name: str, kind: NamedKind[Wanted], apart: Collection[Wanted] = ()) -> Loaded[Wanted]:
    """Import the object called FILE.py:NAME or PACKAGE:NAME, as `load_firmware` does.

    :NAME may be left out if the module has only one object of that kind; those in `apart` do not count. Raises
    FirmwareError if there is no such module or object.
    """
    place, attribute = parted(name, kind.must_be)
    module, own = import_own(*located(place, kind.advice(attribute)))
    attribute = attribute or _only_one(module, name, kind, apart)
    value = getattr(module, attribute, None)
    if not isinstance(value, kind.type):
        found = with_article(type(value).__name__) if hasattr(module, attribute) else "missing"
        raise FirmwareError(
            f"{kind.option}: {attribute} must be a {kind.module}.{kind.type.__name__}, but is {found} "
            f"({path_of(module)}){kind.advice(attribute)}"
        )
    return Loaded(f"{module.__name__}:{attribute}", value, module, own)


def _only_one(module: ModuleType, name: str, kind: NamedKind[Wanted], apart: Collection[Wanted]) -> str:
    names = [
        each
        for each, value in vars(module).items()
        if isinstance(value, kind.type) and not any(value is other for other in apart)
    ]
    if len(names) == 1:
        return names[0]
    has = f"has {' and '.join(names)}" if names else "has none"
    raise FirmwareError(
        f"{kind.option} {cut(name)} must be followed by :NAME unless the module has one {kind.type.__name__}, but it {has} "
        f"({path_of(module)})"
    )
