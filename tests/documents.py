"""Numbers in pages that a command gives: ``python -m tests.documents`` writes them, ``--check`` compares.

A number is marked by a comment behind it, which readers do not see:

    0.53<!--F004-3: light from +x: scratches along y seen-->
    98.1<!--F000-7@OCTANE: pixels that agree * 100-->

names a figure, and a machine where it is not the figure's first; words that only one of its acceptance
checks has, with "ideal: " before them where the check is of the ideal, and "bound: " where the check's bound
is printed; and what the check's value is multiplied by. A study's number is the one in the column and the row
that the words name: "RMS of all, 0.25". The number keeps as many decimals as it is printed with.

What is written whole, a table or what a study says, stands between two comments:

    <!-- P9: begin -->
    <!-- P9: end -->

Words behind the command choose what is measured: ``python -m tests.documents F004-2 precision`` takes the
sources whose names begin with one of them.
"""

import itertools
import re
import sys
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path

import numpy as np

from fixedpipe.effects.acceptance import precision
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.rings import ring_energy
from fixedpipe.effects.figures import FIGURES, Renderer
from fixedpipe.effects.figures.costs import SECONDS
from fixedpipe.effects.figures.kautz_seidel_2000.f004_02_rings import CATALOGUED_DOME
from fixedpipe.effects.reports.figure_record import render
from fixedpipe.effects.studies import STUDIES
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import FUTURE, GEFORCE_3, GEFORCE_256, PROFILES
from tests.support.studies import SLOW as SLOW_STUDIES

ROOT = Path(__file__).parents[1]
PAGES = tuple(
    ROOT / name
    for name in (
        "README.md",
        "docs/precision.md",
        "docs/machine-beside-ideal.md",
        "docs/studies.md",
        "docs/papers/000.md",
        "docs/papers/001.md",
        "docs/papers/002.md",
        "docs/papers/003.md",
        "docs/papers/004.md",
    )
)
_MARK = re.compile(
    r"(?P<number>(?<![\w.])-?\d[\d,]*(?:\.\d+)?)"
    r"<!--(?P<source>\S+): (?P<words>.+?)(?: \* (?P<factor>-?[\d.]+))?-->"
)
_BLOCK = re.compile(r"<!-- (?P<source>[\w-]+): begin -->\n(?P<text>.*?)<!-- (?P=source): end -->", re.DOTALL)
# What a number of a figure is: of the ideal, a bound.
_KIND = re.compile(r"(?:bound: )?(?:ideal: )?")
# Columns of a page's lines; a star that is no mark of Markdown.
WIDTH, STAR = 125, r"\*"
# What a source takes to be compared in ``make test``, in seconds of ``figures.costs.PROCESSOR``.
QUICK = 1.5


@dataclass(frozen=True)
class Stale:
    """What a page says and what is measured: the page and its line, the two texts, and what measured it."""

    page: Path
    line: int
    source: str
    said: str
    measured: str

    def __str__(self) -> str:
        where = f"{self.page.relative_to(ROOT)}:{self.line}"
        return f"{where}: {self.source}: the page says {self.said!r}, measured is {self.measured!r}"


def table(head, rows):
    """A Markdown table as text."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(cells) + " |\n" for cells in lines)


# ------------------------------------------------------------------------------------ numbers with a mark


@lru_cache(maxsize=1)
def _kept(figure_id):
    """Pictures of the ideal, which the machines of one figure share."""
    return {}


def _split(source):
    """The figure and the machine of F004-4@OCTANE."""
    figure_id, _, machine = source.partition("@")
    figure = FIGURES[figure_id]
    return figure, machine or figure.machines[0]


def _checked(source):
    """The values of a figure's acceptance checks on a machine, by name."""
    figure, machine = _split(source)
    renderer = Renderer(PROFILES[machine], figure.method(machine), execute, execute_ideal, _kept(figure.id))
    found = {}
    for check in figure.checks(renderer):
        name = ("ideal: " if check.on is Answer.IDEAL else "") + check.name
        found |= {name: float(check.value), f"bound: {name}": check.bound}
    return found


@cache
def studied(study_id):
    """A study's table, measured on its own machine."""
    study = STUDIES[study_id]
    return study.measure(PROFILES[study.machines[0]] if study.machines else None)


def _tabled(study_id):
    """The numbers of a study's table, by their column and the row's first cells."""
    measured, found = studied(study_id), {}
    columns = measured.columns
    words = [[c.written(v) for c, v in zip(columns, row, strict=True)] for row in measured.rows]
    # So many of its first cells tell a row from all others.
    first = next(n for n in range(len(columns) + 1) if len({tuple(w[:n]) for w in words}) == len(words))
    for row, cells in zip(measured.rows, words, strict=True):
        for column, number in zip(columns[first:], row[first:], strict=True):
            if isinstance(number, int | float):
                found[f"{column.name}, {', '.join(cells[:first])}"] = float(number)
    return found


@cache
def values(source):
    """What a source measures: numbers by what they are. Raises KeyError where there is no such source."""
    if source in NUMBERS:
        return NUMBERS[source]()
    return _tabled(source) if source in STUDIES else _checked(source)


def value(source, words):
    """The one number of a source that the words name.

    Raises LookupError where none has these words, or several.
    """
    known = values(source)
    if words in known:
        return known[words]
    kind = _KIND.match(words)[0]
    fits = [name for name in known if _KIND.match(name)[0] == kind and words.removeprefix(kind) in name]
    if len(fits) != 1:
        raise LookupError(f"{source} has {len(fits)} numbers named {words!r}; there are: {'; '.join(known)}.")
    return known[fits[0]]


def written(number, like):
    """A number with as many decimals as ``like``, and its thousands parted where they are there."""
    decimals = len(like.partition(".")[2])
    text = f"{number:{',' if ',' in like else ''}.{decimals}f}"
    return text if text.strip("-0.,") else text.removeprefix("-")


# ------------------------------------------------------------------------------------ what is measured


def _hundredths(number):
    return f"{255.0 * number:.2f}"


# Of docs/precision.md: document 004's figures of the paper's own technique, and how they are drawn there.
_IDS, _SIZE, _WIDTHS = ("F004-2", "F004-3", "F004-4"), 96, (4, 6, 8, 10, 12, 16)


def _of_frame(figure_id):
    """What ``precision.table`` and ``precision.clamps`` take of a figure on the GeForce 256."""
    figure = FIGURES[figure_id]
    return lambda machine: figure.commands(machine, _SIZE), GEFORCE_256, *figure.dimensions(_SIZE)


@cache
def _by_width(figure_id):
    """Rows of ``precision.table`` on the GeForce 256."""
    return precision.table(*_of_frame(figure_id), _WIDTHS)


def _costs():
    return {"minutes of all figures": sum(SECONDS.values()) / 60.0}


def _per_bit():
    """By what a further bit divides the error as it is shown, of all widths and figures."""
    quotients = []
    for figure_id in _IDS:
        for (bits, wide, _), (more, narrow, _) in itertools.pairwise(_by_width(figure_id)):
            quotients.append((wide.shown / narrow.shown) ** (1.0 / (more - bits)))
    return {"least": min(quotients), "largest": max(quotients)}


def _left_by_clamps():
    """What 16 bits leave of the error as it is computed, 1/255."""
    return {figure_id: 255.0 * _by_width(figure_id)[-1][1].computed for figure_id in _IDS}


# Numbers of a source that is neither a figure nor a study, by its name: a function that gives them by theirs.
NUMBERS: dict[str, Callable[[], dict[str, float]]] = {
    "costs": _costs,
    "per-bit": _per_bit,
    "clamps-at-16-bits": _left_by_clamps,
}


def _precision_widths():
    """Figures by the width of everything, with the machine's clamps and without."""
    head = ["bits of everything"]
    head += [f"{i} {what}" for i in _IDS for what in ("shown", "computed", "without its clamps")]
    rows = []
    for of_one_width in zip(*map(_by_width, _IDS), strict=True):
        bits = of_one_width[0][0]
        cells = [f"{bits} (the chip)" if bits == 8 else str(bits)]
        for _, clamped, free in of_one_width:
            cells += [_hundredths(clamped.shown), _hundredths(clamped.computed), _hundredths(free.computed)]
        rows.append(cells)
    return table(head, rows)


def _precision_clamps():
    """The error as it is computed without each clamp that changes it."""
    rows = []
    for of_one_clamp in zip(*(precision.clamps(*_of_frame(i)) for i in _IDS), strict=True):
        clamp, without = of_one_clamp[0][0], [error.computed for _, error in of_one_clamp]
        if clamp is None or without != rows[0][1]:
            rows.append(("none" if clamp is None else clamp.name, without))
    return table(("clamp left out", *_IDS), [(name, *map(_hundredths, row)) for name, row in rows])


def _precision_parts():
    """F004-1 by the width of each part of a GeForce 3."""
    rows = []
    for part in precision.PARTS:
        eight, sixteen = (
            precision.measure(
                FIGURES["F004-1"],
                precision.at_width(GEFORCE_3, bits, (part,)),
                _SIZE,
                FIGURES["F004-1"].method("GEFORCE_3"),
            ).shown
            for bits in (8, 16)
        )
        name = part.removesuffix("_bits").replace("_", " ")
        rows.append((name, _hundredths(eight), _hundredths(sixteen)))
    return table(("what is made wider", "8 bits", "16 bits"), rows)


def _precision_order():
    """F004-2's right panel against its left: filtered before use, and after."""
    figure, size = FIGURES["F004-2"], 256
    rows = []
    for name, profile, method in (
        ("GeForce 256", GEFORCE_256, figure.methods[0]),
        ("future board, 16-bit combiners", FUTURE, figure.methods[0]),
        ("future board, evaluated before filtering", FUTURE, figure.method("FUTURE")),
    ):
        commands = figure.commands(profile, size, method)
        image = execute(commands, profile, *figure.dimensions(size)).framebuffer.color[..., :3] / 255.0
        aside = 255.0 * (image[:, size:] - image[:, :size])
        rows.append((name, f"{root_mean_square(aside):.2f}", f"{np.abs(aside).max():.0f}"))
    return table(("F004-2, panels of 256 pixels", "RMS of right - left, 1/255", "largest"), rows)


def _energy(number):
    """An energy with three decimals, or one digit where that says more; less than 0.00001 is zero."""
    return f"{number:.3f}" if number >= 0.0095 else f"{float(f'{number:.1g}'):.5f}".rstrip("0").rstrip(".")


def _ring_energies():
    """Ring energies of F004-2 by the order of operations, for maps of 32, 64 and 128 texels."""
    figure, size, maps = FIGURES["F004-2"], 512, (32, 64, 128)

    def energies(machine, answer, panel):
        kept = _kept(figure.id)
        renderer = Renderer(PROFILES[machine], figure.method(machine), execute, execute_ideal, kept)
        found = []
        for map_size in maps:
            image = renderer.window(answer, figure, size, **{**CATALOGUED_DOME, "map_size": map_size})[
                :, panel * size : (panel + 1) * size, 0
            ]
            found.append(ring_energy(image, map_size, 0.25, 0.25)[0])
        return " / ".join(_energy(energy) for energy in found)

    return table(
        ("order of operations", "drawn by", "energy, 32 / 64 / 128 texels"),
        (
            ("evaluate at the texels, filter the results", "software renderer",
             energies("GEFORCE_256", Answer.IDEAL, 0)),
            ("the same", "future board", energies("FUTURE", Answer.MACHINE, 1)),
            ("filter the vectors, then multiply and square", "GeForce 256, GeForce 3, NV2A",
             energies("GEFORCE_256", Answer.MACHINE, 1)),
            ("the same, without rounding", "the ideal", energies("GEFORCE_256", Answer.IDEAL, 1)),
            ("multiply and square at the texels, filter, then (.)+", "Octane, InfiniteReality",
             energies("OCTANE", Answer.MACHINE, 1)),
        ),
    )  # fmt: skip


def _errors():
    """RMS of (machine - ideal) of document 004's figures by machine, each at its own size."""
    machines = {
        "GEFORCE_256": "GeForce 256",
        "GEFORCE_3": "GeForce 3, NV2A",
        "OCTANE": "Octane",
        "INFINITE_REALITY": "InfiniteReality",
        "FUTURE": "future board",
    }
    rows = []
    for figure_id in (*(f"F004-{n}" for n in range(1, 9)), "K05", "K08", "K15", "K18", "K24"):
        figure = FIGURES[figure_id]
        drawn = tuple(machine for machine in machines if machine in figure.machines)
        record = render(figure, drawn, None, None, False, lambda _: None).record
        found = {m["profile"]: _hundredths(m["difference"]["rms"]) for m in record["machines"]}
        rows.append((figure_id, *(found.get(machine, "-") for machine in machines)))
    return table(("figure", *machines.values()), rows)


def _wrapped(text, mark=""):
    """A paragraph of Markdown, or an item of a list, in lines that begin with no mark of their own."""
    lines = textwrap.wrap(
        text, WIDTH, initial_indent=mark, subsequent_indent=" " * len(mark), break_on_hyphens=False
    )
    starts_an_item = any(re.match(r"\s*(?:[-+*#>|=]|\d+[.)])(?:\s|$)", line) for line in lines[1:])
    return mark + text if starts_an_item else "\n".join(lines)


def _study(study_id):
    """A study's title, question and machine, and what its numbers say."""
    study = STUDIES[study_id]
    machine = f" On the {PROFILES[study.machines[0]].name}:" if study.machines else ""
    head = _wrapped(f"**{study.title.replace('*', STAR)}.** {study.question}{machine}")
    findings = [_wrapped(s.replace("*", STAR), "- ") for s in study.findings(studied(study_id))]
    return f"{head}\n\n" + "".join(f"{sentence}\n" for sentence in findings)


# What is written whole, by the name of its source: a function that gives the text.
BLOCKS: dict[str, Callable[[], str]] = {
    "precision-widths": _precision_widths,
    "precision-clamps": _precision_clamps,
    "precision-parts": _precision_parts,
    "precision-order": _precision_order,
    "ring-energies": _ring_energies,
    "errors": _errors,
}


@cache
def block(source):
    """The text of what is written whole."""
    return "\n" + (_study(source) if source in STUDIES else BLOCKS[source]()) + "\n"


# ------------------------------------------------------------------------------------------------ pages


def sources(text):
    """The sources that a page names, in its order."""
    found = [m for pattern in (_MARK, _BLOCK) for m in pattern.finditer(text)]
    return list(dict.fromkeys(m["source"] for m in sorted(found, key=lambda m: m.start())))


def without_measured(text):
    """The text of a page without what is measured, and its marks."""
    return _MARK.sub("", _BLOCK.sub("", text))


def is_quick(source):
    """Whether a source takes a second or two, and not minutes."""
    if source in STUDIES:
        return source not in SLOW_STUDIES
    if source in BLOCKS or source in NUMBERS:
        return source == "costs"
    figure, _ = _split(source)
    return SECONDS[figure.id] / len(figure.machines) <= QUICK


def _now(mark):
    """A mark's number as it is measured now."""
    number = value(mark["source"], mark["words"]) * float(mark["factor"] or 1.0)
    return written(number, mark["number"])


def measured_again(text, source):
    """The text of a page with what a source measures as it is now."""

    def marked(m):
        return _now(m) + m[0][len(m["number"]) :] if m["source"] == source else m[0]

    def whole(m):
        if m["source"] != source:
            return m[0]
        return f"<!-- {source}: begin -->\n{block(source)}<!-- {source}: end -->"

    return _MARK.sub(marked, _BLOCK.sub(whole, text))


def stale(page, text, source):
    """What a page's text says of a source otherwise than it is measured now: a list of Stale."""
    found = []

    def line(position):
        return text.count("\n", 0, position) + 1

    for m in _MARK.finditer(text):
        if m["source"] == source and (now := _now(m)) != m["number"]:
            found.append(Stale(page, line(m.start()), f"{source}: {m['words']}", m["number"], now))
    for m in _BLOCK.finditer(text):
        if m["source"] == source and m["text"] != block(source):
            said, now = m["text"].splitlines(), block(source).splitlines()
            pairs = itertools.zip_longest(said, now, fillvalue="")
            at, pair = next((n, pair) for n, pair in enumerate(pairs) if pair[0] != pair[1])
            found.append(Stale(page, line(m.start("text")) + at, source, *pair))
    return found


def main(arguments):
    """Write the pages, or compare them and end with status 1 where one is stale."""
    check, beginnings = "--check" in arguments, [a for a in arguments if a != "--check"]
    wrong = []
    for page in PAGES:
        text = page.read_text()
        for source in sources(text):
            if beginnings and not source.startswith(tuple(beginnings)):
                continue
            print(f"{page.relative_to(ROOT)}: {source}", file=sys.stderr, flush=True)
            try:
                found = stale(page, text, source)
            except (
                LookupError
            ) as error:  # a check that has another name now; the others are measured all the same
                wrong.append(f"{page.relative_to(ROOT)}: {error}")
                continue
            if check:
                wrong += found
            elif found:
                # The page may have been edited while this was measured.
                page.write_text(measured_again(page.read_text(), source))
    for each in wrong:
        print(each)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
