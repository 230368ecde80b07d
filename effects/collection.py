"""Figures and studies by their ids: found by their modules' names, imported when one is asked for."""

import importlib
import pkgutil
import re
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType
from typing import TypeVar

Held = TypeVar("Held")  # a Figure, a Study


def _parts(identifier):
    """An id in parts that sort: words as words, numbers as numbers."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", identifier)]


class Collection(Mapping[str, Held]):
    """What modules in or below a package hold, by id; in the ids' order.

    package     the package, imported
    attribute   the name of what each module holds: "FIGURE"
    identify    (a module's name without its packages) -> the id it claims, or None where it claims none

    Listing the ids imports nothing. Raises ValueError where two modules claim an id, and when a module whose
    name claims an id holds something with another.
    """

    def __init__(self, package: ModuleType, attribute: str, identify: Callable[[str], str | None]):
        self._attribute = attribute
        found: dict[str, str] = {}
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            identifier = identify(module.name.rpartition(".")[2])
            if identifier is None:
                continue
            if identifier in found:
                raise ValueError(
                    f"{found[identifier]} and {module.name} both claim {identifier}. Give one another id."
                )
            found[identifier] = module.name
        self._modules = {identifier: found[identifier] for identifier in sorted(found, key=_parts)}

    def __getitem__(self, identifier: str) -> Held:
        """The figure or study of that id; imports its module."""
        name = self._modules[identifier]
        value = getattr(importlib.import_module(name), self._attribute)
        if value.id != identifier:
            raise ValueError(
                f"{name} claims {identifier} by its name, and holds {value.id}. Rename one of them."
            )
        return value

    def __contains__(self, identifier: object) -> bool:
        return identifier in self._modules

    def __iter__(self) -> Iterator[str]:
        return iter(self._modules)

    def __len__(self) -> int:
        return len(self._modules)

    def module_of(self, identifier: str) -> str:
        """The dotted name of the module that claims an id."""
        return self._modules[identifier]
