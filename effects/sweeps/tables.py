"""Rows of a sweep as files: CSV, Parquet and NetCDF, written a thousand rows at a time."""

import csv
import itertools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.files import written_whole

_ROWS = 1000  # that are in memory at a time
_NEEDS = "pip install 'fixedpipe[sweep]' brings it. CSV needs nothing more."


def columns_of(rows: Iterable[Mapping[str, Any]], last: Iterable[str]) -> dict[str, type]:
    """The columns of rows, and of which type their values are: bool, int, float or str; by what stands in
    them. A column without values is of str. ``last``: columns that come at the end.
    """
    found: dict[str, type] = {}
    for row in rows:
        for name, value in row.items():
            known = found.setdefault(name, type(None))
            if value is not None and known is not (kind := type(value)):
                found[name] = kind if known is type(None) else _common(known, kind)
    found = {name: str if kind is type(None) else kind for name, kind in found.items()}
    end = {name: found.pop(name) for name in last if name in found}
    return found | end


def _common(first, second):
    """The type that holds values of two: numbers are floats, and anything else words."""
    return float if {first, second} <= {bool, int, float} else str


def _as(kind, value):
    return None if value is None else value if isinstance(value, kind) else kind(value)


def _write_csv(path, columns, rows, about):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(columns), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def _write_parquet(path, columns, rows, about):
    import pyarrow
    from pyarrow import parquet

    types = {bool: pyarrow.bool_(), int: pyarrow.int64(), float: pyarrow.float64(), str: pyarrow.string()}
    fields = [(name, types[kind]) for name, kind in columns.items()]
    schema = pyarrow.schema(fields, {name: str(said) for name, said in about.items()})
    with parquet.ParquetWriter(path, schema) as writer:
        for some in _batches(rows):
            typed = [{name: _as(columns[name], row.get(name)) for name in columns} for row in some]
            writer.write_table(pyarrow.Table.from_pylist(typed, schema))


def _write_netcdf(path, columns, rows, about):
    dataset(rows, columns, about).to_netcdf(path, engine="netcdf4")


def _batches(rows: Iterable[Any]) -> Iterator[list[Any]]:
    rows = iter(rows)
    while some := list(itertools.islice(rows, _ROWS)):
        yield some


def dataset(rows, columns, about):
    """The rows as an ``xarray.Dataset``, with a dimension for each axis of the grid.

    rows     in the grid's order, one for each point
    columns  as ``columns_of``
    about    attributes; "axes" names the grid's axes, from the one that varies slowest

    Numbers that a point lacks are NaN, words empty. Raises Refusal where a point has several rows.
    """
    import numpy as np
    import xarray

    rows, axes = list(rows), about["axes"].split(",") if about["axes"] else []
    places = {name: list(dict.fromkeys(row[name] for row in rows)) for name in axes}
    shape = tuple(len(values) for values in places.values())
    if len(rows) != int(np.prod(shape)):
        raise Refusal(
            f"{len(rows)} rows are no grid of {'x'.join(map(str, shape)) or 'one point'}: each point has a "
            "table. Name the file .csv or .parquet."
        )
    variables = {}
    for name, kind in columns.items():
        if name in axes:
            continue
        values = [row.get(name) for row in rows]
        if kind is str:
            array = np.array(["" if value is None else str(value) for value in values], object)
        elif None in values or kind is float:
            array = np.array([np.nan if value is None else value for value in values], np.float64)
        else:
            array = np.array(values)
        variables[name] = axes, array.reshape(shape)
    return xarray.Dataset(variables, places, {name: str(said) for name, said in about.items()})


# By the ending of a file's name: who writes it, and the modules that it needs.
KINDS: dict[str, tuple[Callable[..., None], tuple[str, ...]]] = {
    ".csv": (_write_csv, ()),
    ".parquet": (_write_parquet, ("pyarrow",)),
    ".nc": (_write_netcdf, ("xarray", "netCDF4")),
}


def check_kind(path: Path) -> None:
    """Raise Refusal for a file's name with another ending than those of KINDS, and if the package that writes
    it is not installed.
    """
    from importlib.util import find_spec

    ending = path.suffix.lower()
    if ending not in KINDS:
        raise Refusal(f"The name {path} must end with one of {', '.join(KINDS)}.")
    for module in KINDS[ending][1]:
        if find_spec(module) is None:
            raise Refusal(f"A file {ending} needs {module}, which is not installed: {_NEEDS}")


def write_table(path: Path, columns: Mapping[str, type], rows: Iterable[Mapping[str, Any]], about) -> None:
    """Write rows by the ending of a file's name, whole or not at all.

    columns  as ``columns_of``
    about    properties of the whole table, by name, if the file format can store them

    Raises Refusal where it cannot be written.
    """
    write, _ = KINDS[path.suffix.lower()]
    with written_whole(path) as temporary:
        try:
            write(temporary, columns, rows, about)
        except OSError as error:
            # Arrow and HDF5 tell the system's number in words of their own.
            said = os.strerror(error.errno) if error.errno else str(error)
            raise Refusal(f"{path} cannot be written: {said}.") from error
