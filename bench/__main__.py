"""``python -m bench [NAME ...] [--peer NAME]``: how fast it draws, in tables and as JSON."""

import argparse
import contextlib
import dataclasses
import json
import os
import sys
from pathlib import Path

from bench import (
    counters,
    growth,
    history,
    limits,
    pictures,
    prefilter,
    processor,
    replays,
    roofline,
    scattering,
    tables,
    viewer,
)
from bench.figures import FIGURES
from bench.goals import applied, goals
from bench.measure import DISTURBED, Ours, summarize, take_turns
from bench.peers.llvmpipe import Llvmpipe
from bench.peers.mesa import PeerError
from bench.peers.swiftshader import SwiftShader
from bench.scenes import SCENES

PEERS = {peer.name: peer for peer in (Llvmpipe, SwiftShader)}
ROOFLINE, GROWTH, SCATTERING = "roofline", "growth", "scattering"
PREFILTER = "prefilter"
NAMES = (*SCENES, *FIGURES, ROOFLINE, GROWTH, SCATTERING, PREFILTER)
# Other commands of the module, each by its first word.
COMMANDS = {
    "history": history.main,
    "tables": tables.main,
    "counters": counters.main,
    "replay": replays.main,
    "viewer": viewer.main,
}


def _arguments(arguments):
    titles = {entry.name: entry.title for entry in (*SCENES.values(), *FIGURES.values())}
    titles |= {ROOFLINE: "memory bandwidth, and what it allows the scenes", GROWTH: "cost by size"}
    titles |= {SCATTERING: "document 002's table 1, and how its costs grow"}
    titles |= {PREFILTER: "environment maps filtered by Phong's lobe"}
    listing = "\n".join(f"  {name:10}{title}" for name, title in titles.items())
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description="Measure how fast the hardware is emulated, beside another renderer.",
        epilog=f"names:\n{listing}\n\n"
        "python -m bench history FILE        what became slower\n"
        "python -m bench tables FILE ...     what --json wrote as Markdown\n"
        "python -m bench counters SCENE ...  instructions of a fragment\n"
        "python -m bench replay FILE ...      frames of recorded programs, beside glretrace\n"
        "python -m bench viewer ID:SIZE ...   from a gesture to pixels, by parts",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="what to measure; everything but all and fresh when none is"
    )
    parser.add_argument("--peer", choices=sorted(PEERS), help="take turns with this renderer")
    parser.add_argument("--threads", type=int, default=2, help="threads for both (2)")
    parser.add_argument(
        "--size", type=int, help="the scenes' framebuffer edge in pixels (1024; 512 for e, e2, t)"
    )
    parser.add_argument("--cpu", choices=limits.LIMITS, help="limit both to a processor's vectors")
    parser.add_argument("--plot", metavar="FILE", help="also draw how scattering's costs grow")
    parser.add_argument("--json", metavar="FILE", help="also write everything as one object")
    parser.add_argument("--history", metavar="FILE", help="also append the run's numbers as a line")
    parser.add_argument(
        "--images", metavar="DIR", help="save the scenes' pictures and compare them, measuring nothing"
    )
    options = parser.parse_args(arguments)
    unknown = [name for name in options.names if name not in NAMES]
    if unknown:
        parser.error(f"there is no {', '.join(unknown)}; the names are {', '.join(NAMES)}.")
    everything = [name for name in NAMES if name not in FIGURES or not FIGURES[name].is_long]
    options.names = options.names or list(SCENES if options.images else everything)
    other = [name for name in options.names if name not in SCENES]
    if options.images and other:
        parser.error(f"{', '.join(other)} has no picture; with --images name scenes: {', '.join(SCENES)}.")
    if options.threads < 1:
        parser.error(f"--threads is {options.threads}; give 1 or more.")
    if options.size is not None and not 1 <= options.size <= 2048:
        parser.error(f"--size is {options.size}; give 1 to 2048 pixels.")
    if options.plot and SCATTERING not in options.names:
        parser.error(f"--plot draws what {SCATTERING} measures; name it too.")
    if options.history and options.images:
        parser.error("--history keeps what is measured, and --images measures nothing; give one of them.")
    options.processor = processor.read()
    if options.cpu and (lacking := limits.refusal(options.cpu, options.processor)):
        parser.error(lacking)
    for path in filter(None, (options.json, options.images, options.plot, options.history)):
        folder = Path(path).absolute().parent
        if not os.access(folder, os.W_OK):
            parser.error(f"{path} cannot be written: {folder} is not a folder that you may write to.")
    return options


class _Table:
    """A table printed row by row: columns of (heading, width), to the left where the width is negative."""

    def __init__(self, title, *columns):
        self._widths = [width for _, width in columns]
        print(f"\n{title}")
        self.row(*(heading for heading, _ in columns))

    def row(self, *cells):
        """Print a row; None is shown as a dash."""
        shown = ("-" if cell is None else str(cell) for cell in cells)
        line = "  ".join(
            f"{cell:<{-width}}" if width < 0 else f"{cell:>{width}}"
            for cell, width in zip(shown, self._widths, strict=True)
        )
        print(line.rstrip(), flush=True)


def _number(value, form):
    return None if value is None else format(value, form)


def _compare(parties, scenes, options):
    """Save and compare; whether every scene is as expected."""
    same = True
    for scene in scenes:
        for party in parties:
            party.prepare(scene, options.size or scene.size)
        shown = {party.name: party.picture() for party in parties}
        pictures.save(options.images, scene, shown)
        if len(shown) < 2:
            print(f"{scene.name:5}saved; nothing to compare it with", flush=True)
            continue
        found = pictures.difference(*shown.values(), scene.levels)
        verdict = "as expected" if found.as_expected(scene) else "MORE THAN EXPECTED"
        same = same and found.as_expected(scene)
        print(
            f"{scene.name:5}{verdict}: largest difference {found.color} levels, "
            f"{found.beyond / found.pixels:.2%} of the pixels beyond {scene.levels}; "
            f"pixels that only one drew {found.coverage}; depth {found.depth} units; stencil {found.stencil}",
            flush=True,
        )
    return same


def _measure_scenes(parties, scenes, options):
    """The scenes' Rows, printed."""
    table = _Table(
        "Scenes",
        ("scene", -5),
        ("size", 5),
        ("threads", 7),
        ("unit", -12),
        ("ours", 8),
        ("aim", 5),
        ("peer", 8),
        ("ratio", 6),
        ("goal", 5),
        ("spread", 6),
    )
    # What is asked for are ratios to llvmpipe.
    asked = {} if options.peer == SwiftShader.name else goals(options.processor, options.cpu)
    rows = []
    for scene in scenes:
        size = options.size or scene.size
        for party in parties:
            party.prepare(scene, size)
        row = summarize(scene, size, options.threads, take_turns(parties), asked.get(scene.name))
        rows.append(row)
        table.row(
            scene.name,
            size,
            options.threads,
            scene.unit,
            f"{row.ours:.1f}",
            _number(scene.aim, "g"),
            _number(row.peer, ".1f"),
            _number(row.ratio, ".2f"),
            _number(row.goal, ".2f"),
            f"{row.spread:.0%}",
        )
    below = [row.scene.name for row in rows if row.is_below]
    if below:
        print(f"Below the goal: {', '.join(below)}.")
    _warn_of_disturbed({row.scene.name: row.spread for row in rows})
    return rows


def _measure_figures(figures, options):
    """The figures as the objects of ``--json``, printed."""
    table = _Table(
        "Figures",
        ("name", -8),
        ("", -48),
        ("measured", 10),
        ("goal", 8),
        ("unit", -9),
        ("", -7),
        ("spread", 6),
    )
    asked, found = goals(options.processor, options.cpu), []
    for figure in figures:
        try:
            measured = figure.measure(options.threads)
        except OSError as problem:
            print(f"{figure.name} was not measured: {problem}", file=sys.stderr)
            continue
        met = figure.is_met(measured.value, asked[figure.name])
        goal = f"{'≤' if figure.most else '≥'} {asked[figure.name]:g}"
        verdict = "reached" if met else "MISSED"
        spread = _number(measured.spread, ".0%")
        table.row(figure.name, figure.title, f"{measured.value:.4g}", goal, figure.unit, verdict, spread)
        for name, value in measured.details.items():
            table.row("", name, f"{value:.4g}", "", figure.unit, "", "")
        found.append(
            {
                "figure": figure.name,
                "title": figure.title,
                "unit": figure.unit,
                "measured": float(f"{measured.value:.4g}"),
                "goal": asked[figure.name],
                "relation": "at most" if figure.most else "at least",
                "reached": met,
                "spread": None if measured.spread is None else round(measured.spread, 3),
                "details": {name: float(f"{value:.4g}") for name, value in measured.details.items()},
            }
        )
    _warn_of_disturbed({line["figure"]: line["spread"] or 0.0 for line in found})
    return found


def _warn_of_disturbed(spreads):
    """Name those whose turns differ too much, of name -> spread."""
    if loud := [f"{name} ({spread:.0%})" for name, spread in spreads.items() if spread > DISTURBED]:
        print(f"Disturbed, their turns differ by more than a tenth: {', '.join(loud)}. Measure them again.")


def _measure_roofline(rows, options):
    """Bandwidths, and every scene's traffic with the bound that follows, printed; ``--json``'s object.

    ``rows``: the scenes that were measured, whose share of the bound is told.
    """
    measured = roofline.measure_bandwidths(options.threads)
    table = _Table("Bandwidth", ("access", -14), ("MiB", 5), ("threads", 7), ("GB/s", 6))
    for found in measured:
        table.row(found.access, found.bytes >> 20, found.threads, f"{found.rate / 1e9:.1f}")
    rates = {(b.bytes, b.access): b.rate for b in measured if b.threads == options.threads}
    bounds = {
        where: (rates[size, "write"], rates[size, "read and write"])
        for where, size in (("cache", roofline.IN_CACHE), ("memory", roofline.OUT_OF_CACHE))
    }
    parts = ("clear", "color", "depth", "stencil", "texture", "geometry")
    table = _Table(
        "Roofline: bytes a fragment (e, e2: a triangle) moves; the rates that bandwidth alone allows",
        ("scene", -5),
        *((part, 8) for part in parts),
        ("bytes", 7),
        ("cache", 8),
        ("memory", 8),
        ("ours", 8),
        ("of cache", 8),
        ("unit", -12),
    )
    ours = {row.scene.name: row for row in rows}
    lines = []
    for scene in SCENES.values():
        row = ours.get(scene.name)
        moved = roofline.traffic(scene, row.size if row else options.size or scene.size)
        bound = {where: moved.bound(*rate) / 1e6 for where, rate in bounds.items()}
        share = row.ours / bound["cache"] if row else None
        table.row(
            scene.name,
            *(f"{getattr(moved, part):.1f}" for part in parts),
            f"{moved.total:.1f}",
            f"{bound['cache']:.1f}",
            f"{bound['memory']:.1f}",
            _number(row and row.ours, ".1f"),
            _number(share, ".1%"),
            scene.unit,
        )
        lines.append(
            {
                "scene": scene.name,
                "unit": scene.unit,
                "bytes": {part: round(getattr(moved, part), 3) for part in parts},
                "cache_bound": round(bound["cache"], 1),
                "memory_bound": round(bound["memory"], 1),
                "ours": row and round(row.ours, 3),
                "share_of_cache_bound": share and round(share, 4),
            }
        )
    bandwidth = [
        {"access": b.access, "bytes": b.bytes, "threads": b.threads, "gigabytes_per_second": b.rate / 1e9}
        for b in measured
    ]
    return {"bandwidth": bandwidth, "scenes": lines}


def _measure_growth(options):
    """Every curve's points by its name, printed; ``--json``'s object."""
    found = {}
    for curve in growth.CURVES.values():
        table = _Table(
            f"Growth: {curve.title}",
            (curve.name, 9),
            ("rate", 8),
            ("unit", -12),
            ("ms a frame", 10),
            ("ns each", 8),
        )
        found[curve.name] = []
        for point in growth.measure(curve, options.threads):
            table.row(
                point.number,
                f"{point.rate:.2f}",
                point.unit,
                f"{point.milliseconds:.3f}",
                f"{1e3 / point.rate:.2f}",
            )
            found[curve.name].append(
                {
                    curve.name: point.number,
                    "unit": point.unit,
                    "rate": round(point.rate, 3),
                    "milliseconds": round(point.milliseconds, 4),
                }
            )
    return found


def _measure_scattering(options):
    """Table 1 and its growth, printed, and drawn where asked for; ``--json``'s object."""
    name = scattering.processor()
    table = _Table(
        f"Scattering, {name}: seconds, the paper's and ours",
        ("field", -10),
        ("step", -12),
        ("paper", 8),
        ("ours", 9),
        ("times", 7),
        ("goal", 6),
    )
    times = []
    for found in scattering.measure(options.threads):
        table.row(
            found.field,
            found.step,
            _number(found.paper, "g"),
            f"{found.seconds:.4f}",
            _number(found.paper and found.paper / found.seconds, ".0f"),
            _number(found.goal, "g"),
        )
        times.append(
            {
                "field": found.field,
                "step": found.step,
                "seconds": round(found.seconds, 5),
                "paper": found.paper,
                "goal": found.goal,
            }
        )
    table = _Table("Growth: 32 x 32 ridges", ("what", -12), ("number", 6), ("step", -12), ("ms", 9))
    points = []
    for what, number, step, seconds in scattering.growth():
        table.row(what, number, step, f"{1e3 * seconds:.2f}")
        points.append((what, number, step, seconds))
    if options.plot:
        scattering.plot(points, options.plot)
    grown = [
        {"what": what, "number": number, "step": step, "seconds": round(seconds, 5)}
        for what, number, step, seconds in points
    ]
    return {"processor": name, "times": times, "growth": grown}


def _measure_prefilter(options):
    """Maps filtered on the host, printed; ``--json``'s list."""
    table = _Table(
        "Environment maps filtered by Phong's lobe: seconds",
        ("edge", 5),
        ("exponent", 9),
        ("ours", 8),
        ("goal", 5),
    )
    found = list(prefilter.measure(options.threads))
    for time in found:
        table.row(time.size, f"{time.exponent:g}", f"{time.seconds:.3f}", _number(time.goal, "g"))
    return [dataclasses.asdict(time) for time in found]


def _measure(parties, options):
    """The object of ``--json`` but what of the run is only known when the parties have ended."""
    chosen = dict.fromkeys(options.names)
    scenes = [SCENES[name] for name in chosen if name in SCENES]
    rows = _measure_scenes(parties, scenes, options) if scenes else []
    figures = [FIGURES[name] for name in chosen if name in FIGURES]
    return {
        "threads": options.threads,
        "peer": parties[1].description if len(parties) > 1 else None,
        "scenes": [row.as_json() for row in rows],
        "figures": _measure_figures(figures, options) if figures else [],
        "roofline": _measure_roofline(rows, options) if ROOFLINE in chosen else None,
        "growth": _measure_growth(options) if GROWTH in chosen else None,
        "scattering": _measure_scattering(options) if SCATTERING in chosen else None,
        "prefilter": _measure_prefilter(options) if PREFILTER in chosen else None,
    }


def _run(options):
    """On what a run is made, printed: the head of the object of ``--json``."""
    run = {
        "date": processor.today(),
        "commit": processor.commit(),
        "processor": options.processor.as_json(),
        "cpu": options.cpu,
        "versions": processor.versions(),
    }
    packages = ", ".join(f"{name} {version}" for name, version in run["versions"].items())
    print(f"{options.processor}; {packages}; {run['date']}, commit {run['commit'] or 'unknown'}")
    if options.cpu:
        print(f"--cpu {options.cpu}: {limits.LIMITS[options.cpu].means}")
    print(applied(options.processor), flush=True)
    return run


def _keep(run, others, options):
    """Say whether others computed meanwhile, and write the run where it is asked for."""
    run["others"] = None if others is None else round(others, 3)
    if others is not None and others > processor.QUIET:
        print(f"Others took {others:.0%} of the cores' time: these are numbers of a disturbed machine.")
        if options.threads == 1:
            print(
                "On one thread, scenes are measured in processor time: their spread says how much it matters."
            )
    if options.json:
        Path(options.json).write_text(json.dumps(run, indent=2) + "\n")
    if options.history:
        history.append(options.history, run)


def main(arguments=None):
    """Run the command line and return the exit status.

    1: the pictures differ more than expected, the peer failed after it had started, or (history) a number
    became slower.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    if arguments and arguments[0] in COMMANDS:
        return COMMANDS[arguments[0]](arguments[1:])
    options = _arguments(arguments)
    if options.cpu and limits.current() != options.cpu:
        return limits.run_again(options.cpu, arguments)
    run = _run(options) if not options.images else {}
    disturbance = processor.Disturbance()
    with contextlib.ExitStack() as stack:
        parties = [Ours(options.threads)]
        if options.peer:
            try:
                parties.append(stack.enter_context(PEERS[options.peer](options.threads)))
                print(f"{options.peer}: {parties[1].description}")
            except PeerError as problem:
                print(f"Without {options.peer}: {problem}", file=sys.stderr)
        try:
            if options.images:
                return 0 if _compare(parties, [SCENES[name] for name in options.names], options) else 1
            run |= _measure(parties, options)
        except PeerError as problem:
            print(problem, file=sys.stderr)
            return 1
    _keep(run, disturbance.share(), options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
