"""Public names of a package that are imported when they are first used."""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any


def import_when_used(
    package: str, homes: Mapping[str, Sequence[str]]
) -> tuple[Callable[[str], Any], Callable[[], list[str]], tuple[str, ...]]:
    """Return `__getattr__`, `__dir__` and `__all__` of a package.

    `homes` has the names by the module that defines them. A type checker does not read it: the
    package imports the same names again below `if TYPE_CHECKING`.
    """
    modules = {name: module for module, names in homes.items() for name in names}

    def imported(name: str) -> Any:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(modules[name]), name)

    return imported, lambda: sorted(modules), tuple(modules)
