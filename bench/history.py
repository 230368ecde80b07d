"""Speed over time: a file with a line of JSON for every run, what became slower, and a page that shows it.

``python -m bench history FILE [--plot PAGE]``; ``python -m bench ... --history FILE`` appends.
"""

import argparse
import json
import statistics
import sys
from dataclasses import dataclass, field
from html import escape
from io import StringIO
from pathlib import Path

from bench.measure import DISTURBED

# A number that is this much worse than the median of former runs is named.
SLOWER = 0.1
# Of a page, curves in a row; of a curve, its size in inches.
_COLUMNS, _SIZE = 3, (4.2, 2.2)
# What a line has of a run's object; the rest is long, or of the bench alone.
_KEPT = ("date", "commit", "processor", "cpu", "versions", "threads", "peer", "others", "scenes", "figures")
_IMAGES = {".png", ".svg", ".pdf"}


def append(file, run):
    """Add a run, the object of ``--json``, to a file as one line; makes the file where there is none."""
    line = json.dumps({name: run[name] for name in _KEPT})
    with Path(file).open("a", encoding="utf-8") as lines:
        lines.write(line + "\n")


def read(file):
    """The runs of a file, oldest first. Raises ValueError that names the first line that is no run."""
    runs = []
    for number, line in enumerate(Path(file).read_text(encoding="utf-8").splitlines(), 1):
        if not line.strip():
            continue
        try:
            run = json.loads(line)
            missing = [name for name in _KEPT if name not in run]
        except (ValueError, TypeError) as problem:
            raise ValueError(f"{file}, line {number} is not JSON: {problem}.") from None
        if missing:
            raise ValueError(f"{file}, line {number} is no run of the bench: it lacks {', '.join(missing)}.")
        runs.append(run)
    return sorted(runs, key=lambda run: run["date"])


@dataclass(frozen=True)
class Point:
    """A number of one run.

    value    in the series' unit
    spread   of its turns, as a share; None where it is not known
    date     of the run, ISO 8601
    commit   of the run
    """

    value: float
    spread: float | None
    date: str
    commit: str

    @property
    def disturbed(self):
        """Whether the turns of the measurement differ by more than a tenth."""
        return self.spread is not None and self.spread > DISTURBED


@dataclass
class Series:
    """A number over time on one kind of processor.

    name    of the scene or figure
    unit    of the values: "times llvmpipe", "Mfragments/s", "µs" ...
    where   the processor, the limit, the threads, and the edge in pixels where it is a scene's
    most    whether less is better
    points  oldest first
    """

    name: str
    unit: str
    where: str
    most: bool
    points: list[Point] = field(default_factory=list)

    def change(self):
        """How much worse the last point is than the median of the others, as a share: 0.1 is a tenth of the
        speed lost; below 0 it became faster. None where there are no others.
        """
        *former, last = (point.value for point in self.points)
        if not former:
            return None
        usual = statistics.median(former)
        speed = usual / last if self.most else last / usual
        return 1.0 - speed

    @property
    def is_slower(self):
        """Whether the last point has lost a tenth of the speed or more."""
        change = self.change()
        return change is not None and round(change, 9) >= SLOWER


def _where(run):
    limit = f", {run['cpu']}" if run["cpu"] else ""
    processor = run["processor"]
    numbers = f"family {processor['family']}, model {processor['model']}"
    threads = "1 thread" if run["threads"] == 1 else f"{run['threads']} threads"
    return f"{processor['name']} ({numbers}), {processor['cores']} cores{limit}, {threads}"


def peer_of(run):
    """The name of a run's peer, with which its description begins; None where there was none."""
    return run["peer"] and run["peer"].partition(" ")[0]


def _numbers(run):
    """(name, unit, where, whether less is better, value, spread) of all that a run measured.

    A scene's number is its ratio where a peer was there, because what slows both is no slow-down of ours.
    """
    where = _where(run)
    for scene in run["scenes"]:
        at = f"{where}, {scene['size']}²"
        if scene["ratio"] is None:
            yield scene["scene"], scene["unit"], at, False, scene["ours"], scene["spread"]
        else:
            yield scene["scene"], f"times {peer_of(run)}", at, False, scene["ratio"], scene["spread"]
    for figure in run["figures"]:
        most = figure["relation"] == "at most"
        yield figure["figure"], figure["unit"], where, most, figure["measured"], figure["spread"]


def series(runs):
    """The Series of runs, which are given oldest first: each scene and figure on each processor."""
    found = {}
    for run in runs:
        for name, unit, where, most, value, spread in _numbers(run):
            own = found.setdefault((name, unit, where), Series(name, unit, where, most))
            own.points.append(Point(value, spread, run["date"], run["commit"]))
    return list(found.values())


def compared(runs):
    """The Series in which the newest run has runs before it."""
    keys = {(one.name, one.unit, one.where) for one in series(runs[-1:])}
    return [s for s in series(runs) if (s.name, s.unit, s.where) in keys and len(s.points) > 1]


def slower(runs):
    """Those in which the newest run lost a tenth or more."""
    return [one for one in compared(runs) if one.is_slower]


def sentence(one):
    """What became slower, by how much, and whether the measurement can be trusted."""
    last, former = one.points[-1], one.points[:-1]
    usual = statistics.median(point.value for point in former)
    said = (
        f"{one.name} is {one.change():.0%} slower: {last.value:.4g} {one.unit} where the median of "
        f"{len(former)} former run{'s' * (len(former) > 1)} is {usual:.4g} ({one.where})."
    )
    if last.disturbed:
        said += f" Its turns differ by {last.spread:.0%}: measure it again on a quiet machine."
    return said


# ------------------------------------------------------------------------------------------------ page


def _figure(shown):
    """matplotlib's figure of Series: a small plot each, the runs in their order, slow-downs in red; each says
    its processor where there are several.
    """
    from matplotlib.figure import Figure

    rows, several = -(-len(shown) // _COLUMNS), len({one.where for one in shown}) > 1
    figure = Figure(figsize=(_SIZE[0] * _COLUMNS, _SIZE[1] * rows), layout="constrained")
    for number, one in enumerate(shown):
        axes = figure.add_subplot(rows, _COLUMNS, number + 1)
        places = range(len(one.points))
        values = [point.value for point in one.points]
        axes.plot(places, values, "o-", color="#2a5d8f", markersize=3, linewidth=1)
        for place, point in zip(places, one.points, strict=True):
            if point.disturbed:
                axes.plot(place, point.value, "o", color="white", markeredgecolor="#2a5d8f", markersize=5)
        if one.is_slower:
            axes.plot(places[-1], values[-1], "o", color="#c0392b", markersize=6)
        axes.set_ylim(0, 1.15 * max(values))
        axes.set_title(f"{one.name}: {values[-1]:.4g} {one.unit}", fontsize=9)
        if several:
            axes.text(0.02, 0.04, one.where, fontsize=5, transform=axes.transAxes)
        few = sorted({0, len(places) - 1})
        axes.set_xticks(few, [f"{one.points[k].date[:10]}\n{one.points[k].commit}" for k in few], fontsize=6)
        axes.tick_params(axis="y", labelsize=7)
    return figure


def _page(found, sentences):
    """The HTML page: what became slower, then the curves of every processor."""
    parts = [
        "<!doctype html><meta charset='utf-8'><title>fixedpipe: speed over time</title>",
        "<style>body{font:15px/1.5 sans-serif;max-width:80em;margin:2em auto;padding:0 1em}"
        "svg{max-width:100%;height:auto}.slower{color:#c0392b}</style>",
        "<h1>Speed over time</h1>",
        "<p>Each curve is a number of <code>python -m bench</code>, run by run; of scenes the ratio to "
        "the peer where one was there. Hollow points were disturbed; a red one has lost a tenth or more of "
        "the median of the runs before it on the same processor.</p>",
        *(f"<p class='slower'>{escape(text)}</p>" for text in sentences),
    ]
    groups = {}
    for one in found:
        groups.setdefault(one.where, []).append(one)
    for where, shown in groups.items():
        text = StringIO()
        _figure(shown).savefig(text, format="svg")
        svg = text.getvalue()
        parts.append(f"<h2>{escape(where)}</h2>\n{svg[svg.index('<svg') :]}")
    return "\n".join(parts) + "\n"


def plot(runs, path):
    """Write every Series of runs as a page (.html) or one picture (.png, .svg, .pdf).

    Raises ValueError for another ending, or where matplotlib is not installed.
    """
    path = Path(path)
    if path.suffix not in _IMAGES | {".html"}:
        raise ValueError(f"{path} ends with {path.suffix or 'nothing'}; give .html, .png, .svg or .pdf.")
    found = series(runs)
    try:
        if path.suffix == ".html":
            path.write_text(_page(found, [sentence(one) for one in slower(runs)]), encoding="utf-8")
        else:
            _figure(found).savefig(path, dpi=110)
    except ImportError:
        raise ValueError("matplotlib is not installed: pip install 'fixedpipe[plots]'.") from None


def main(arguments):
    """``python -m bench history``: returns 1 where the newest run is slower than those before it, else 0."""
    parser = argparse.ArgumentParser(
        prog="python -m bench history",
        description="What the newest run of a history lost against the median of the runs before it on the "
        "same processor. Exit status: 1 where a number lost a tenth or more, 0 where none did.",
    )
    parser.add_argument("file", metavar="FILE", help="what --history has written")
    parser.add_argument("--plot", metavar="PAGE", help="also draw every number: .html, .png, .svg or .pdf")
    options = parser.parse_args(arguments)
    try:
        runs = read(options.file)
        if not runs:
            raise ValueError(
                f"{options.file} has no runs; python -m bench --history {options.file} adds one."
            )
        if options.plot:
            plot(runs, options.plot)
    except OSError as problem:
        parser.error(f"{problem.filename}: {problem.strerror}; python -m bench --history FILE writes one.")
    except ValueError as problem:
        parser.error(str(problem))
    newest, former, found = runs[-1], compared(runs), slower(runs)
    print(f"{newest['date']}, commit {newest['commit'] or 'unknown'}, {_where(newest)}.")
    for one in found:
        print(sentence(one), file=sys.stderr)
    print(f"{len(former)} numbers have former runs to compare with; {len(found)} lost a tenth or more.")
    return 1 if found else 0
