"""A study as data: an artefact of the hardware, how it is measured on the emulator, and the results."""

import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from numpy.typing import NDArray

from fixedpipe.effects.acceptance.check import Check
from fixedpipe.pipeline.profiles.profile import Profile

# Columns of a terminal that a printed table fits.
WIDTH = 80
# What a row of a table has under a heading.
Value: TypeAlias = float | int | str | None


@dataclass(frozen=True)
class Column:
    """A column of a table: its heading, its unit ("" for a pure number) and the format of its values."""

    name: str
    unit: str = ""
    form: str = ""

    def written(self, value: Value) -> str:
        """A value as text. None, for a value that a row lacks, becomes a dash."""
        return "-" if value is None else format(value, self.form)


@dataclass(frozen=True, eq=False)
class Table:
    """The results of a study: rows of numbers and words under headings.

    columns   Column, in order
    rows      tuples as long as ``columns``: numbers, words, or None if a row has no such value
    curves    data for the plot that are not in the rows: float64 arrays by name
    """

    columns: tuple[Column, ...]
    rows: tuple[tuple[Value, ...], ...]
    curves: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    def column(self, name: str) -> list[Any]:
        """The values of the column with this heading, in order."""
        (k,) = [k for k, column in enumerate(self.columns) if column.name == name]
        return [row[k] for row in self.rows]

    def records(self) -> list[dict[str, Any]]:
        """The rows as dicts by heading, for a JSON file."""
        names = [column.name for column in self.columns]
        return [dict(zip(names, row, strict=True)) for row in self.rows]

    def text(self) -> str:
        """The table as lines of plain text: headings above their units, numbers aligned to the right."""
        cells = [[c.written(v) for c, v in zip(self.columns, row, strict=True)] for row in self.rows]
        out = []
        for k, column in enumerate(self.columns):
            body = [row[k] for row in cells]
            words = [*column.name.split(), *column.unit.split()]
            width = max(map(len, (*words, *body)))
            head = textwrap.wrap(column.name, width) + textwrap.wrap(column.unit, width)
            side = "<" if column.form == "" else ">"
            out.append((width, side, head, body))
        height = max(len(head) for _, _, head, _ in out)
        lines = []
        for n in range(height):
            lines.append(
                [f"{h[n - height + len(h)] if n >= height - len(h) else '':{s}{w}}" for w, s, h, _ in out]
            )
        lines.append(["-" * width for width, *_ in out])
        for n in range(len(cells)):
            lines.append([f"{body[n]:{side}{width}}" for width, side, _, body in out])
        return "\n".join("  ".join(line).rstrip() for line in lines)


@dataclass(frozen=True, kw_only=True)
class Study:
    """An artefact of the hardware and how it is measured.

    id          the catalogue's id: P<number>
    title       the artefact in a few words
    question    the study's question, one sentence
    method      how the answer is measured
    source      key in docs/bibliography.bib
    techniques  the catalogue's ids of the techniques that are used
    machines    keys of ``fixedpipe.pipeline.profiles.PROFILES`` of machines that it can be measured on, its
                own first; empty: the study compares machines, or needs none
    measure     (profile) -> Table; the profile of one of ``machines``, or None if there are none
    findings    (Table) -> tuple of sentences that state the findings with the table's numbers
    checks      (Table) -> Checks, in a tuple or one after the other: the catalogue's numbers for the study's
                own machine
    plot        (axes, Table) -> None: draws on ``panels`` matplotlib axes
    """

    id: str
    title: str
    question: str
    method: str
    source: str
    techniques: tuple[str, ...]
    machines: tuple[str, ...] = ()
    panels: int = 1
    measure: Callable[[Profile | None], Table]
    findings: Callable[[Table], tuple[str, ...]]
    checks: Callable[[Table], Iterable[Check]]
    plot: Callable[[Any, Table], None]


# Colours of plots that people with any colour vision tell apart.  Source: Okabe, Ito 2008.
BLUE, ORANGE, GREEN, RED = "#0072B2", "#E69F00", "#009E73", "#D55E00"
PURPLE, SKY, BLACK = "#CC79A7", "#56B4E9", "#000000"
# How a plot marks a number that the catalogue expects.
EXPECTED = {"color": BLACK, "marker": "D", "linestyle": "none", "markersize": 6, "markerfacecolor": "white"}
