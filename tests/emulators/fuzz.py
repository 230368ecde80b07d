"""Fuzzes the exported C99 against our kernels: ``python -m tests.emulators.fuzz``.

Every rule's function is compiled by cc, and computes random inputs in batches; the kernels that draw
compute the same. It prints a line for each rule, and ends with status 1 where a bit differs.
"""

import argparse
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.names import constant_of
from tests.emulators.c99 import Library
from tests.emulators.calls import call_of, constants, wrong_rows
from tests.emulators.kernels import FUZZED, Drawn

INPUTS = 10_000_000  # of each rule
LEAST = 256  # inputs of a batch: a row of blocks


def _words(base, column, count, id_="", name=""):
    """A column as words, uint32 [count, k]."""
    if base == "name":
        names = column if isinstance(column, list) else [column]
        numbers = [constants()[constant_of(id_, name, each)] for each in names]
        return np.tile(np.array(numbers, np.uint32), (count, 1))
    if np.ndim(column) == 0:
        column = np.full(count, column)
    column = np.asarray(column).reshape(count, -1)
    if base == "int":
        return column.astype(np.int64).astype(np.uint32)
    if base == "single":
        if column.dtype.kind in "iu":  # a block's words
            return column.astype(np.uint32)
        return np.ascontiguousarray(column, np.float64).astype(np.float32).view(np.uint32)
    return np.ascontiguousarray(column, np.float64).view(np.uint32).reshape(count, -1)


def batches(id_, inputs, seed):
    """(given, expected) as words, until there are so many inputs; each batch from a seed of its own."""
    entry, call, left, number = FUZZED[id_], call_of(id_), inputs, 0
    while left > 0:
        random = np.random.default_rng([seed, number, zlib.crc32(id_.encode())])
        columns = entry.draw(Drawn(random, min(entry.batch, -(-left // LEAST) * LEAST)))
        count = max(np.shape(c)[0] for c in columns if isinstance(c, np.ndarray))
        with np.errstate(all="ignore"):
            found = entry.compute(*columns)
        values = zip(call.inputs.items(), columns, strict=True)
        given = [_words(value.base, column, count, id_, name) for (name, value), column in values]
        yield np.concatenate(given, axis=1), _words(call.output.base, found, count)
        left, number = left - count, number + 1


def fuzz(library, id_, inputs, seed):
    """(how many inputs, how many of them differ, the first that does: words given, found and expected)."""
    call, seen, wrong, first = call_of(id_), 0, 0, None
    for given, expected in batches(id_, inputs, seed):
        found = library.run(call, given)
        rows = wrong_rows(call, found, expected)
        seen, wrong = seen + len(given), wrong + len(rows)
        if first is None and len(rows):
            first = tuple([f"0x{w:08x}" for w in words[rows[0]]] for words in (given, found, expected))
    return seen, wrong, first


def main():
    """Fuzz the rules that the command line names, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--inputs", type=int, default=INPUTS, help=f"of each rule; {INPUTS:,} if not given")
    parser.add_argument("--rule", action="append", choices=[*RULES], metavar="ID", help="this rule; else all")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    ids = arguments.rule or [*RULES]
    bad = 0
    with tempfile.TemporaryDirectory() as folder:
        library = Library([call_of(id_) for id_ in ids], Path(folder))
        for id_ in ids:
            seen, wrong, first = fuzz(library, id_, arguments.inputs, arguments.seed)
            print(f"{id_}: {wrong} of {seen} differ" + (f"; first {first}" if first else ""), flush=True)
            bad += wrong > 0
    print(f"{len(ids) - bad} of {len(ids)} rules agree")
    return bad > 0


if __name__ == "__main__":
    sys.exit(main())
