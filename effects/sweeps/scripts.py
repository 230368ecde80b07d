"""Scripts of users that a sweep draws: ``commands`` is a function of the varied values."""

import runpy
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from inspect import Parameter, signature
from typing import Any

from fixedpipe.effects.refusal import Refusal, line_of
from fixedpipe.pipeline.profiles.profile import Profile

_PROFILE = "profile"


@dataclass(frozen=True)
class Script:
    """What a script defines.

    path     the file
    make     its ``commands``: a function of keywords, or the commands themselves
    machine  its ``profile``: a Profile or a key of PROFILES
    size     its ``width`` and ``height``, pixels
    measure  its function ``measure``, or None
    """

    path: str
    make: Any
    machine: Profile | str
    size: tuple[int, int]
    measure: Callable[..., Mapping[str, Any]] | None

    @property
    def names(self) -> tuple[str, ...]:
        """What may be varied: the keywords of ``commands``, without ``profile``."""
        if not callable(self.make):
            return ()
        return tuple(name for name in signature(self.make).parameters if name != _PROFILE)

    def check(self, values: Mapping[str, Any]) -> None:
        """Raise Refusal for a name that is none of ``names``, and for one without a value."""
        if not callable(self.make) and values:
            raise Refusal(
                f"{self.path}: commands is no function, so {', '.join(values)} cannot be varied; write "
                f"def commands({', '.join(values)}): ..."
            )
        takes_all = callable(self.make) and any(
            one.kind is Parameter.VAR_KEYWORD for one in signature(self.make).parameters.values()
        )
        for name in values.keys() - set(self.names):
            if not takes_all:
                there = ", ".join(self.names) or "none"
                raise Refusal(f"{self.path}: commands takes no {name!r}; it takes: {there}.")
        if callable(self.make):
            known = signature(self.make).parameters
            missing = [n for n in self.names if known[n].default is Parameter.empty and n not in values]
            missing = [n for n in missing if known[n].kind is not Parameter.VAR_KEYWORD]
            if missing:
                raise Refusal(
                    f"{self.path}: commands needs {', '.join(missing)}; vary it, or give it a default."
                )

    def commands(self, profile: Profile, values: Mapping[str, Any]) -> tuple[Any, ...]:
        """The frame for a machine and values. Raises Refusal for any exception of the script."""
        if not callable(self.make):
            return tuple(self.make)
        more = {_PROFILE: profile} if _PROFILE in signature(self.make).parameters else {}
        return tuple(self._call(self.make, **values, **more))

    def measured(self, result: Any, ideal: Any, values: Mapping[str, Any]) -> dict[str, Any]:
        """What ``measure(result, ideal, **values)`` returns: columns by name, numbers or words."""
        if self.measure is None:
            return {}
        found = self._call(self.measure, result, ideal, **values)
        if not isinstance(found, Mapping):
            raise Refusal(f"{self.path}: measure returned {type(found).__name__}; return a dict of numbers.")
        return {str(name): value for name, value in found.items()}

    def _call(self, function, *arguments, **keywords):
        try:
            return function(*arguments, **keywords)
        except Exception as error:
            where = line_of(self.path, error)
            raise Refusal(f"{self.path}{where} raised {type(error).__name__}: {error}") from error


@cache  # in a process, a script is run once
def script_of(path: str) -> Script:
    """The Script of a file. Raises Refusal where it cannot be read or run, or lacks a name."""
    try:
        made = runpy.run_path(path)
    except OSError as error:
        raise Refusal(f"{path} cannot be read: {error.strerror}.") from None
    except (Exception, SystemExit) as error:
        raise Refusal(f"{path}{line_of(path, error)} raised {type(error).__name__}: {error}") from error
    missing = [name for name in ("commands", "profile", "width", "height") if name not in made]
    if missing:
        raise Refusal(
            f"{path} does not define {', '.join(missing)}; it needs commands, profile, width, height."
        )
    size = made["width"], made["height"]
    return Script(path, made["commands"], made["profile"], size, made.get("measure"))
