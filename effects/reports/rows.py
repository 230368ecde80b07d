"""A command's printed numbers as rows: dicts with equal keys, for pandas and for JSON and CSV files.

Numbers are not rounded. Shares are from 0 to 1. A cell that a row lacks is None.
"""

import csv
import io
import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.inspection.maps import Map
from fixedpipe.pipeline.inspection.registers import RegisterUse
from fixedpipe.pipeline.inspection.what_if import Error

Rows: TypeAlias = list[dict[str, Any]]


def register_rows(uses: Iterable[RegisterUse]) -> Rows:
    """A row for each RegisterUse, by the names of its fields."""
    return [asdict(use) for use in uses]


def map_rows(maps: Iterable[Map]) -> Rows:
    """A row for each Map: command, label, and the names of ``Map.numbers``."""
    told = [(each, each.numbers()) for each in maps]
    names = list(dict.fromkeys(name for _, numbers in told for name in numbers))
    return [
        {"command": each.command, "label": each.label, **{name: numbers.get(name) for name in names}}
        for each, numbers in told
    ]


def share_gone(error: Error, own: Error) -> float:
    """By which share ``error`` is less than the machine's ``own`` visible error; below 0: it is greater."""
    return 1.0 - error.shown / own.shown if own.shown else 0.0


def error_rows(own: Error, found: Iterable[tuple[str, Error]]) -> Rows:
    """A row for the machine's own Error, "as it is", and one for each entry of ``found``.

    ``found``: a result of ``attribution`` or ``stage_attribution``. Errors are in 1/255 of full intensity;
    ``goes`` is the share that is gone.
    """
    return [
        {"what": what, **_printed(error), "goes": share_gone(error, own)}
        for what, error in (("as it is", own), *found)
    ]


def pixel_rows(machine: NDArray[np.float64], ideal: NDArray[np.float64]) -> Rows:
    """A row for each pixel of a picture's row: x, and red, green and blue of the machine and of the ideal, in
    1/255 of full intensity. ``machine``, ``ideal``: float64 [w, 3], 1.0 = full intensity.
    """
    names = ("red", "green", "blue")
    return [
        {
            "x": x,
            **{name: 255 * value for name, value in zip(names, drawn.tolist(), strict=True)},
            **{f"ideal {name}": 255 * value for name, value in zip(names, meant.tolist(), strict=True)},
        }
        for x, (drawn, meant) in enumerate(zip(machine, ideal, strict=True))
    ]


def precision_rows(
    table: Iterable[tuple[int, Error, Error]], clamps: Iterable[tuple[Clamp | None, Error]]
) -> Rows:
    """A row for each Error of ``precision.table`` and ``precision.clamps``, in 1/255 of full intensity.

    ``bits``: None: the machine's own. ``without``: the clamp that is left out; "its own": all clamps that
    only machines have; None: none.
    """
    rows: Rows = []
    for bits, clamped, free in table:
        for without, error in ((None, clamped), ("its own", free)):
            rows.append({"bits": bits, "without": without, **_printed(error)})
    for clamp, error in clamps:
        rows.append({"bits": None, "without": clamp and clamp.name, **_printed(error)})
    return rows


def _printed(error: Error) -> dict[str, float]:
    """An Error in 1/255, by the columns' names."""
    numbers = (error.shown, *error.channels, error.largest, error.computed)
    names = ("shown", "red", "green", "blue", "largest", "computed")
    return {name: 255 * value for name, value in zip(names, numbers, strict=True)}


def json_text(rows: Any) -> str:
    """Rows as the text of a JSON file: a list of objects."""
    return json.dumps(rows, indent=2, allow_nan=False) + "\n"


def csv_text(rows: Iterable[Mapping[str, Any]]) -> str:
    """Rows as the text of a CSV file: a line of names, and a line for each row; None is an empty cell.

    Source: RFC 4180, but lines end in a line feed alone.
    """
    rows = list(rows)
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else [], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()
