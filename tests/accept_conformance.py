"""Accept how many pixels agree with the captures: ``make accept-conformance``, ``WORSE=yes`` if fewer do.

``tests/conformance/accepted.txt`` has a line for every capture, as ``fixedpipe conformance`` prints it but
without a reason. Fewer equal pixels than accepted fail a test; more should be accepted, so that they stay.
README.md and docs/silicon.md get their numbers from it.
"""

import argparse
import os
import re
import sys
from datetime import date
from pathlib import Path

from fixedpipe.effects.conformance.captures import find_captures
from fixedpipe.effects.conformance.case import Inputs
from fixedpipe.effects.conformance.redraw import known_suites
from fixedpipe.effects.conformance.run import Totals, compare_all
from fixedpipe.effects.reports.files import write_whole
from tests.conftest import CAPTURES

ACCEPTED = Path(__file__).parent / "conformance" / "accepted.txt"
DOCUMENTS = tuple(Path(__file__).parents[1] / page for page in ("README.md", "docs/silicon.md"))
_INPUTS = Path(os.environ.get("FIXEDPIPE_INPUTS") or CAPTURES.resolve() / ".." / ".." / "inputs")
INPUTS = Inputs(_INPUTS if _INPUTS.is_dir() else None)

# A case's pixels, equal and compared, by its name SUITE/CASE; None: not covered.
Counts = dict[str, tuple[int, int] | None]


def to_text(counts: Counts):
    return "".join(
        f"{name}: {'not covered' if c is None else f'{c[0]} / {c[1]}'}\n"
        for name, c in sorted(counts.items())
    )


def from_text(text) -> Counts:
    found = {}
    for line in text.splitlines():
        name, equal, compared = re.fullmatch(r"(\S+): (?:not covered|(\d+) / (\d+))", line).groups()
        found[name] = None if equal is None else (int(equal), int(compared))
    return found


def count(captures, inputs):
    """Redraw the captures: their Counts, the notes of those that ended with an error, by name, and the names
    of those that are not exact and do not say why.
    """
    counts, errors, unexplained = {}, {}, []
    for c in compare_all(captures, known_suites(), inputs):
        name = f"{c.suite}/{c.name}"
        counts[name] = (c.pixels_equal, c.pixels_compared) if c.covered else None
        if c.failed:
            errors[name] = c.note
        if c.covered and not (c.exact or c.note):
            unexplained.append(name)
    return counts, errors, unexplained


def changes(accepted: Counts, found: Counts):
    """What got worse and what got better, two lists of sentences, over the cases of ``accepted``."""
    worse, better = [], []
    for name, before in accepted.items():
        now = found.get(name)
        if now == before:
            continue
        said = f"{name}: {_words(before)}, now {_words(now)}"
        lost = before and (now is None or now[0] < before[0] or now[1] < before[1])
        no_longer_exact = before and now and before[0] == before[1] and now[0] < now[1]
        (worse if lost or no_longer_exact else better).append(said)
    return worse, better


def _words(counts):
    return "not covered" if counts is None else f"{counts[0]} of {counts[1]} pixels equal"


def totals(counts: Counts):
    """The Totals of every suite, by its name, and of all."""
    of_suite, whole = {}, Totals()
    for name, c in sorted(counts.items()):
        equal, compared = c or (0, 0)
        one = Totals(
            int(c is not None and equal == compared), int(c is not None), equal, compared, int(not c)
        )
        suite = name.split("/")[0]
        of_suite[suite] = of_suite.get(suite, Totals()) + one
        whole += one
    return of_suite, whole


def table(counts: Counts):
    """The table of docs/silicon.md."""
    of_suite, whole = totals(counts)
    rows = [*of_suite.items(), ("**all**", whole)]
    return "| suite | exact cases | equal pixels | not covered |\n|---|---|---|---|\n" + "".join(
        f"| {suite} | {t.exact} of {t.cases} | {t.pixels_equal} of {t.pixels_compared} | {t.not_covered} |\n"
        for suite, t in rows
    )


def with_results(text, counts: Counts):
    """A document with the table and the last line of the command as they follow from the counts."""
    begin, end = "<!-- begin table -->\n", "<!-- end table -->"
    text = re.sub(f"(?<={begin}).*(?={end})", lambda _: table(counts), text, flags=re.DOTALL)
    line = r"exact: \d+ of \d+ cases; pixels: \d+ of \d+; not covered: \d+"
    return re.sub(line, str(totals(counts)[1]), text)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Accept how many pixels agree with the captures.")
    parser.add_argument("--worse", action="store_true", help="accept fewer equal pixels too")
    options = parser.parse_args(arguments)
    if not CAPTURES.is_dir():
        print(f"There is no folder {CAPTURES}; set FIXEDPIPE_CAPTURES.", file=sys.stderr)
        return 2
    found, errors, unexplained = count(find_captures(CAPTURES), INPUTS)
    for name, note in errors.items():
        print(f"{name}: error: {note}", file=sys.stderr)
    for name in unexplained:
        print(f"{name}: some pixels differ; say why in the case's explanation", file=sys.stderr)
    if errors or unexplained:
        return 1
    before = from_text(ACCEPTED.read_text()) if ACCEPTED.is_file() else {}
    worse, better = changes(before | dict.fromkeys(found.keys() - before.keys()), found)
    for kind, said in (("worse", worse), ("better", better)):
        for sentence in said:
            print(f"{kind}: {sentence}")
    if worse and not options.worse:
        print(f"{len(worse)} got worse. If that is right: make accept-conformance WORSE=yes", file=sys.stderr)
        return 1
    write_whole(ACCEPTED, to_text(found).encode())
    for page in DOCUMENTS:
        text = re.sub(r"(?<=accepted on )[\d-]+", date.today().isoformat(), page.read_text())
        write_whole(page, with_results(text, found).encode())
    print(f"Accepted: {len(better)} better, {len(worse)} worse, {len(found)} captures in all.")
    if worse:
        print("Say why in CHANGELOG.md, in a line that begins `Bits:`.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
