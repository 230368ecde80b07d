"""The tables of docs/performance.md from the objects of ``--json``: ``python -m bench tables FILE ...``."""

import argparse
import json
from pathlib import Path

from bench.history import peer_of
from bench.measure import DISTURBED
from bench.processor import QUIET
from bench.scenes import SCENES

BEGIN, END = "<!-- Tables begin -->", "<!-- Tables end -->"
NOTHING = "\N{EN DASH}"
_CODE = {
    None: "as it is",
    "avx512": "with AVX-512",
    "avx2": "limited to AVX2",
    "generic": "limited to SSE2",
}


def _row(*cells):
    return f"| {' | '.join(cells)} |"


def _table(heads, rows):
    return "\n".join([_row(*heads), _row(*("---" for _ in heads)), *(_row(*row) for row in rows)])


def _shown(value, form=".4g"):
    return NOTHING if value is None else format(value, form)


def _who(run):
    """The processor as a user would name it, under which limit, and beside whom where it is not llvmpipe."""
    own = run["processor"]
    name = f"{own['name']} ({own['kind']})" if own["kind"] == "Zen 5" else own["name"]
    beside = f", beside {peer_of(run)}" if peer_of(run) not in (None, "llvmpipe") else ""
    return f"{name}, {_CODE[run['cpu']]}{beside}"


def _threads(run):
    return "1 thread" if run["threads"] == 1 else f"{run['threads']} threads"


def _title(run):
    return f"{_who(run)}, {_threads(run)}"


def _ratio(row):
    """A ratio, bold where it misses its goal."""
    if row["ratio"] is None:
        return NOTHING
    text = f"{row['ratio']:.2f}"
    return f"**{text}**" if row["goal"] is not None and row["ratio"] < row["goal"] else text


def ratios(runs):
    """A row for each run: on what, when, and the ratio of every scene."""
    known = {row["scene"] for run in runs for row in run["scenes"]}
    names = [name for name in SCENES if name in known]
    rows, goals = [], {}
    for run in runs:
        own = {row["scene"]: row for row in run["scenes"]}
        goals |= {name: row["goal"] for name, row in own.items() if row["goal"] is not None}
        ratios = [_ratio(own[name]) if name in own else NOTHING for name in names]
        rows.append([_who(run), str(run["threads"]), run["date"][:10], *ratios])
    asked = [_shown(goals.get(name), "g") for name in names]
    return _table(["processor", "threads", "date", *names], [*rows, ["asked for", "", "", *asked]])


def rates(run):
    """Every scene of a run: both rates, ratio, goal, aim and spread."""
    rows = [
        [
            row["scene"],
            str(row["size"]),
            row["unit"],
            _shown(row["ours"]),
            _shown(row["aim"], "g"),
            _shown(row["peer"]),
            _ratio(row),
            _shown(row["goal"], "g"),
            f"{row['spread']:.0%}",
        ]
        for row in run["scenes"]
    ]
    heads = ["scene", "size", "unit", "ours", "aim", peer_of(run) or "peer", "ratio", "goal", "spread"]
    return _table(heads, rows)


def _goal(figure):
    if figure["goal"] is None:
        return NOTHING
    return f"{'≤' if figure['relation'] == 'at most' else '≥'} {figure['goal']:g}"


_REACHED = {True: "yes", False: "**no**", None: NOTHING}


def figures(run):
    """Every figure of a run: what was measured, with its details, and the goal."""
    rows = []
    for figure in run["figures"]:
        details = ", ".join(f"{name} {value:.4g}" for name, value in figure["details"].items())
        measured = f"{figure['measured']:.4g}" + (f" ({details})" if details else "")
        spread = _shown(figure["spread"], ".0%")
        reached = _REACHED[figure["reached"]]
        rows.append([figure["figure"], measured, _goal(figure), figure["unit"], reached, spread])
    return _table(["name", "measured", "goal", "unit", "reached", "spread"], rows)


def _conditions(run):
    """On what a run was measured and how quiet it was, in sentences."""
    own, versions = run["processor"], run["versions"]
    packages = ", ".join(f"{name} {version}" for name, version in versions.items())
    said = [
        f"{own['cores']} cores of {own['name']} (family {own['family']}, model {own['model']}; "
        f"{', '.join(own['extensions'])}), {_CODE[run['cpu']]}; {run['date'][:10]}, commit "
        f"{run['commit'] or 'unknown'}.",
        f"{packages}; {run['peer'] or 'no peer'}.",
    ]
    loud = [row for row in run["scenes"] if row["spread"] > DISTURBED]
    if loud:
        named = ", ".join(f"{row['scene']} ({row['spread']:.0%})" for row in loud)
        said.append(f"Disturbed, spread above a tenth: {named}.")
    elif run["scenes"]:
        said.append(f"Spread {max(row['spread'] for row in run['scenes']):.0%} or less.")
    if run["others"] is not None and run["others"] > QUIET:
        said.append(f"Others took {run['others']:.0%} of the cores' time.")
    return " ".join(said)


def markdown(runs):
    """All tables of some runs: the ratios of all, then each with its rates and figures."""
    parts = []
    if any(run["scenes"] for run in runs):
        parts.append(ratios([run for run in runs if run["scenes"]]))
    for run in runs:
        parts += [f"#### {_title(run)}", _conditions(run)]
        parts += [rates(run)] * bool(run["scenes"]) + [figures(run)] * bool(run["figures"])
    return "\n\n".join(parts) + "\n"


def put_into(page, text):
    """The page's text with ``text`` between its two marks. Raises ValueError where it lacks one."""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the page has no lines {BEGIN} and {END} to put the tables between.")
    return f"{before}{BEGIN}\n\n{text}\n{END}{after}"


def main(arguments):
    """``python -m bench tables``: print the tables, or write them into a page; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m bench tables", description="What --json wrote as the tables of docs/performance.md."
    )
    parser.add_argument("files", nargs="+", metavar="FILE", help="objects of --json, in the tables' order")
    parser.add_argument("--into", metavar="PAGE", help=f"write them into a page between {BEGIN} and {END}")
    options = parser.parse_args(arguments)
    try:
        text = markdown([json.loads(Path(file).read_text(encoding="utf-8")) for file in options.files])
        if options.into:
            page = Path(options.into)
            page.write_text(put_into(page.read_text(encoding="utf-8"), text), encoding="utf-8")
        else:
            print(text, end="")
    except OSError as problem:
        parser.error(
            f"{problem.filename}: {problem.strerror}; give files that --json wrote, and a page that is there."
        )
    except ValueError as problem:
        parser.error(str(problem))
    except KeyError as problem:
        parser.error(
            f"{problem} is missing in one of {', '.join(options.files)}: measure it again with --json."
        )
    return 0
