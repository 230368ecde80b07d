"""How long figures took on this computer, so that the next run says how long it will take."""

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fixedpipe.effects.figures import costs

_FILE = "figure-seconds.json"
_ROUNDS = "first", "whole"


@dataclass
class OwnTimes:
    """Processor seconds of figures in their own sizes, by id.

    first  of the picture on the first machine and by the ideal
    whole  of all machines, references and checks
    """

    first: dict[str, float] = field(default_factory=dict)
    whole: dict[str, float] = field(default_factory=dict)

    def of_first(self, figures: Iterable[Any]) -> float:
        """Seconds of figures' first pictures; times that were not measured here come from elsewhere."""
        figures = list(figures)
        speed = self._speed(self.first, lambda figure: costs.seconds_of([figure]), figures)
        return sum(self.first.get(f.id) or speed * costs.seconds_of([f]) for f in figures)

    def of_whole(
        self, figures: Iterable[Any], machines: Mapping[str, tuple[str, ...]], speed: float = 1.0
    ) -> float:
        """Seconds of figures on these machines, with references and checks.

        ``speed``: this computer's seconds for one second of another, if nothing was measured here yet.
        """
        figures = list(figures)
        speed = self._speed(self.whole, lambda figure: costs.SECONDS[figure.id], figures, speed)
        return sum(
            (self.whole.get(f.id) or speed * costs.SECONDS[f.id]) * len(machines[f.id]) / len(f.machines)
            for f in figures
        )

    @staticmethod
    def _speed(measured, elsewhere, figures, otherwise=1.0):
        """How many seconds here one of another computer takes, by the figures that were measured here."""
        known = [figure for figure in figures if figure.id in measured]
        there = sum(elsewhere(figure) for figure in known)
        return sum(measured[figure.id] for figure in known) / there if there else otherwise

    def knows(self, figures: Iterable[Any]) -> bool:
        """Whether most of the figures were measured here."""
        figures = list(figures)
        return 2 * sum(figure.id in self.whole for figure in figures) > len(figures)

    def write(self, folder: Path) -> None:
        """Store them in a folder, with those of other figures; a full disc stores none."""
        before = read_times(folder)
        merged = {name: getattr(before, name) | getattr(self, name) for name in _ROUNDS}
        rounded = {name: {i: round(s, 2) for i, s in times.items()} for name, times in merged.items()}
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            (folder / _FILE).write_text(json.dumps(rounded) + "\n")


def read_times(folder: Path | None) -> OwnTimes:
    """The times that a folder stores; none if there is no such file, or if it is not as written."""
    found = OwnTimes()
    with suppress(OSError, ValueError, AttributeError, TypeError):
        read = json.loads((folder / _FILE).read_bytes()) if folder else {}
        for name in _ROUNDS:
            times = {i: float(s) for i, s in read.get(name, {}).items()}
            getattr(found, name).update({i: s for i, s in times.items() if 0.0 < s < 1e6})
    return found
