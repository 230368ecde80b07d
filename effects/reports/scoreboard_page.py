"""Another renderer compared with a chip and with ours, as a page that can be published.

The page is one file, without scripts and without links to other files.
"""

import heapq
from dataclasses import dataclass, field, replace
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.conformance.redraw import Comparison
from fixedpipe.effects.conformance.scoreboard import Row, Score
from fixedpipe.effects.reports.conformance import LEGEND, difference_picture, inline_picture
from fixedpipe.effects.reports.scoreboard import by_suite
from fixedpipe.effects.reports.style import STYLE

CAPTURES = "https://github.com/abaire/nxdk_pgraph_tests_golden_results"
SHOWN = 24  # cases with pictures: the other's worst
_SHRUNK = 2  # a picture's pixels along each axis, of which one is shown

_MORE_STYLE = """
.bar { display: inline-block; width: 6rem; height: .55rem; background: var(--mat); margin-right: .6rem; }
.bar i { display: block; height: 100%; background: var(--good); }
.worst { display: grid; gap: .6rem; grid-template-columns: repeat(3, minmax(0, 1fr)); }
.worst { margin: .4rem 0 1.6rem; }
.worst img { width: 100%; height: auto; }
h3 { font: 1rem/1.4 system-ui, sans-serif; margin: 1.6rem 0 .2rem; }
.legend span { display: inline-block; margin-right: 1.2rem; white-space: nowrap; }
.legend i { display: inline-block; width: .9rem; height: .9rem; margin-right: .4rem; vertical-align: -.1rem; }
.total { font-size: 1.15rem; } table { min-width: 0; }
"""


@dataclass
class ScoreboardPage:
    """The page under construction. ``name``: the other renderer's.

    Cases are added one by one. It has the SHOWN pictures with the most wrong pixels.
    """

    name: str
    _rows: dict[tuple[str, str], Row] = field(default_factory=dict)
    _worst: list[tuple[int, str, str, str]] = field(default_factory=list)

    def add(self, comparison: Comparison, row: Row, other: NDArray[np.uint8] | None) -> None:
        """Add a covered Comparison, its Row, and the other renderer's picture; None: it has none."""
        c = comparison
        self._rows[c.suite, c.name] = row
        wrong = row.other.pixels - row.other.equal
        if other is None or not wrong or (len(self._worst) == SHOWN and wrong <= self._worst[0][0]):
            return
        keep = heapq.heappush if len(self._worst) < SHOWN else heapq.heappushpop
        keep(self._worst, (wrong, c.suite, c.name, self._pictures(c, other)))

    def _pictures(self, c, other):
        theirs = replace(c, ours=other, equal=(other == c.theirs).all(-1))
        shown = {
            "the chip": c.theirs,
            self.name: other,
            "difference": difference_picture(theirs, wide=True),
        }
        return "".join(
            f"<figure>{inline_picture(picture[::_SHRUNK, ::_SHRUNK], f'{c.suite}/{c.name}, {what}')}"
            f"<figcaption>{escape(what)}</figcaption></figure>"
            for what, picture in shown.items()
        )

    def text(self) -> str:
        """The whole page."""
        suites = by_suite(self._rows)
        total = suites.pop("all")
        title = f"{self.name} beside a real NV2A"
        return (
            '<!doctype html><html lang="en"><head><meta charset="utf-8">'
            f"<title>{escape(title)}</title>"
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<style>{STYLE}{_MORE_STYLE}</style></head><body><h1>{escape(title)}</h1>"
            f"{self._summary(total)}{self._suites(suites)}{self._pictured()}{self._cases()}</body></html>\n"
        )

    def _summary(self, total):
        missing = total.other.missing
        without = f" It has no picture of {_count(missing, 'capture')}; these count for neither." * bool(
            missing
        )
        rows = "".join(
            f'<tr><td>{escape(name)}</td><td class="number">{score.exact:,} of {score.cases:,}</td>'
            f'<td class="number">{score.equal:,} of {score.pixels:,}</td>'
            f"<td>{_bar(score.equal, score.pixels)}</td>"
            f'<td class="number">{_share(score.within_one, score.pixels)}</td></tr>'
            for name, score in ((self.name, total.other), ("fixedpipe", total.ours))
        )
        head = _head("renderer", "exact cases", "equal pixels", "", "within 1")
        return (
            '<p class="quiet">Programs of nxdk_pgraph_tests drew pictures on an Xbox, whose framebuffers are '
            f'published as <a href="{CAPTURES}">captures</a>. Both renderers are compared with them in the '
            "same regions: the whole picture without the text, which the processor wrote. A pixel is equal "
            "where all four components are. Nothing is tolerated; <em>within 1</em> is only counted. A case "
            f"is exact where every compared pixel is equal.{without}</p>"
            f'<div class="table"><table>{head}{rows}</table></div>'
        )

    def _suites(self, suites):
        body = "".join(
            f'<tr><td>{escape(suite)}</td><td class="number {_kind(row.other)}">{row.other.exact} of '
            f"{row.other.cases}</td><td>{_bar(row.other.equal, row.other.pixels)}</td>"
            f'<td class="number">{row.other.largest}</td><td class="number {_kind(row.ours)}">'
            f"{row.ours.exact} of {row.ours.cases}</td><td>{_bar(row.ours.equal, row.ours.pixels)}</td>"
            f'<td class="number">{row.other.missing or ""}</td></tr>'
            for suite, row in suites.items()
        )
        own = escape(self.name)
        head = _head(
            *("suite", f"{own}: exact", "equal pixels", "largest difference"),
            *("fixedpipe: exact", "equal pixels", "no picture"),
        )
        return f'<section><h2>By suite</h2><div class="table"><table>{head}{body}</table></div></section>'

    def _pictured(self):
        if not self._worst:
            return ""
        legend = "".join(
            f'<span><i style="background: rgb{color}"></i>{escape(words)}</span>' for color, words in LEGEND
        )
        cases = "".join(
            f"<h3>{escape(suite)}/{escape(name)}: {wrong:,} pixels differ</h3>"
            f'<div class="worst">{pictures}</div>'
            for wrong, suite, name, pictures in sorted(self._worst, key=lambda case: (-case[0], case[1:3]))
        )
        return (
            f'<section><h2>Where {escape(self.name)} differs most</h2><p class="quiet legend">{legend}</p>'
            f"{cases}</section>"
        )

    def _cases(self):
        rows = "".join(
            f"<tr><td>{escape(suite)}/{escape(name)}</td>{_cell(row.other)}{_cell(row.ours)}</tr>"
            for (suite, name), row in self._rows.items()
        )
        head = _head("case", self.name, "fixedpipe")
        return (
            "<section><h2>Every case</h2><details><summary>equal pixels of those compared</summary>"
            f'<div class="table"><table>{head}{rows}</table></div></details></section>'
        )


def _count(number, noun):
    return f"{number:,} {noun}{'s' * (number != 1)}"


def _head(*names: Any) -> str:
    return "<tr>" + "".join(f"<th>{escape(name)}</th>" for name in names) + "</tr>"


def _share(part, whole):
    return f"{100 * part / whole:.4f} %" if whole else ""


def _bar(part, whole):
    if not whole:
        return ""
    share = 100 * part / whole
    # A share below all never looks or reads like all.
    shown = min(share, 99.9999) if part < whole else share
    return f'<span class="bar"><i style="width: {shown:.2f}%"></i></span>{shown:.4f} %'


def _kind(score: Score) -> str:
    return "ok" if score.exact == score.cases else "failed"


def _cell(score):
    if not score.cases:
        return '<td class="number quiet">no picture</td>'
    return f'<td class="number {_kind(score)}">{score.equal} / {score.pixels}</td>'
