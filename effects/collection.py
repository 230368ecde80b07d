"""Figures and studies by their ids: found by their modules' names, and imported on first use."""

import importlib
import pkgutil
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from fixedpipe.effects.refusal import NoSuchName, Refusal, no_such

Held = TypeVar("Held")  # a Figure, a Study


def _parts(identifier):
    """An id in parts that sort: words as words, numbers as numbers."""
    return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", identifier)]


class Collection(Mapping[str, Held]):
    """What modules in or below a package hold, by id; in the ids' order.

    package     the package, imported
    attribute   the name of what each module holds: "FIGURE"
    identify    (a module's name without its packages) -> the id it claims, or None where it claims none
    form        how a module is named that claims an id, for sentences
    beside      names of modules in the package itself that claim none

    What lies in a folder ``shared`` claims no id either. Listing the ids imports nothing. Raises Refusal
    where two modules claim an id, or a module is named in another way or lies in a folder that is no package,
    and would not be found; and, when an id is asked for, where its module holds nothing, something with
    another id, or what refuses to be made.
    """

    def __init__(
        self,
        package: ModuleType,
        attribute: str,
        identify: Callable[[str], str | None],
        form: str,
        beside: tuple[str, ...] = (),
    ):
        self._attribute = attribute
        modules = (file for root in package.__path__ for file in Path(root).glob("*/*.py"))
        for folder in sorted({file.parent for file in modules}):
            if not (folder / "__init__.py").exists():
                raise Refusal(
                    f"The folder {folder.name} of {package.__name__} has no __init__.py, so what is in it "
                    "would not be found. Give it one that says in a line whose it is."
                )
        helpers = {f"{package.__name__}.{name}" for name in beside}
        found: dict[str, str] = {}
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            *folders, name = module.name.split(".")
            if module.ispkg or "shared" in folders or module.name in helpers:
                continue
            identifier = identify(name)
            if identifier is None:
                raise Refusal(
                    f"{module.name} is named by no id, so what it holds would not be found. Call it "
                    f"{form}; what several share goes into the folder's shared."
                )
            if identifier in found:
                raise Refusal(
                    f"{found[identifier]} and {module.name} both claim {identifier}. Give one another id."
                )
            found[identifier] = module.name
        self._modules = {identifier: found[identifier] for identifier in sorted(found, key=_parts)}

    def __getitem__(self, identifier: str) -> Held:
        """The figure or study of that id; imports its module. Raises NoSuchName, a KeyError."""
        if identifier not in self._modules:
            raise NoSuchName(no_such(self._attribute.lower(), identifier, self._modules))
        name = self._modules[identifier]
        try:
            value = getattr(importlib.import_module(name), self._attribute, None)
        except ValueError as error:
            raise Refusal(f"{name} cannot be used: {error}") from error
        if value is None:
            raise Refusal(
                f"{name} claims {identifier} by its name, and holds no {self._attribute}. End it with "
                f"{self._attribute} = {self._attribute.capitalize()}(id={identifier!r}, ...), or put it into "
                "the folder's shared."
            )
        if value.id != identifier:
            raise Refusal(
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
