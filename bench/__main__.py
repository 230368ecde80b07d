"""``python -m bench [SCENE ...] [--peer llvmpipe]``: how fast scenes are drawn, in a table and as JSON."""

import argparse
import contextlib
import json
import os
import sys
from pathlib import Path

from bench import pictures
from bench.measure import Ours, summarize, take_turns
from bench.peers.llvmpipe import Llvmpipe, PeerError
from bench.scenes import SCENES

PEERS = {"llvmpipe": Llvmpipe}
_HEADINGS = ("scene", "size", "threads", "unit", "ours", "aim", "peer", "ratio", "goal", "spread")


def _arguments(arguments):
    listing = "\n".join(f"  {scene.name:4}{scene.title}" for scene in SCENES.values())
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description="Measure how fast the GeForce 256 is emulated, beside another renderer.",
        epilog=f"scenes:\n{listing}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "scenes", nargs="*", metavar="SCENE", help="what to draw; everything when none is named"
    )
    parser.add_argument("--peer", choices=sorted(PEERS), help="take turns with this renderer")
    parser.add_argument("--threads", type=int, default=2, help="threads for both (2)")
    parser.add_argument("--size", type=int, help="framebuffer edge in pixels (1024; 512 for e and e2)")
    parser.add_argument("--json", metavar="FILE", help="also write the table as a list of objects")
    parser.add_argument(
        "--images", metavar="DIR", help="save the pictures and compare them, measuring nothing"
    )
    options = parser.parse_args(arguments)
    unknown = [name for name in options.scenes if name not in SCENES]
    if unknown:
        parser.error(f"there is no scene {', '.join(unknown)}; the scenes are {', '.join(SCENES)}.")
    if options.threads < 1:
        parser.error(f"--threads is {options.threads}; give 1 or more.")
    if options.size is not None and not 1 <= options.size <= 2048:
        parser.error(f"--size is {options.size}; give 1 to 2048 pixels.")
    for path in filter(None, (options.json, options.images)):
        folder = Path(path).absolute().parent
        if not os.access(folder, os.W_OK):
            parser.error(f"{path} cannot be written: {folder} is not a folder that you may write to.")
    return options


def _line(cells):
    widths = (5, 5, 7, 12, 8, 5, 8, 6, 5, 6)
    left = ("scene", "unit")
    return "  ".join(
        f"{cell:<{width}}" if heading in left else f"{cell:>{width}}"
        for heading, cell, width in zip(_HEADINGS, cells, widths, strict=True)
    )


def _cells(row):
    scene = row.scene
    cells = (
        scene.unit,
        f"{row.ours:.1f}",
        _number(scene.aim, "g"),
        _number(row.peer, ".1f"),
        _number(row.ratio, ".2f"),
        _number(scene.goal, ".2f"),
        f"{row.spread:.0%}",
    )
    return (scene.name, row.size, row.threads, *cells)


def _number(value, form):
    return "-" if value is None else format(value, form)


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
            f"drawn by one only {found.coverage}; depth {found.depth} units; stencil {found.stencil}",
            flush=True,
        )
    return same


def _measure(parties, scenes, options):
    print(_line(_HEADINGS))
    rows = []
    for scene in scenes:
        size = options.size or scene.size
        for party in parties:
            party.prepare(scene, size)
        rows.append(summarize(scene, size, options.threads, take_turns(parties)))
        print(_line(_cells(rows[-1])), flush=True)
    below = [row.scene.name for row in rows if row.is_below]
    if below:
        print(f"Below the goal: {', '.join(below)}.")
    if options.json:
        Path(options.json).write_text(json.dumps([row.as_json() for row in rows], indent=2) + "\n")


def main(arguments=None):
    """Run the command line and return the exit status.

    1: the pictures differ more than expected, or the peer failed after it had started.
    """
    options = _arguments(arguments)
    scenes = [SCENES[name] for name in options.scenes or SCENES]
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
                return 0 if _compare(parties, scenes, options) else 1
            _measure(parties, scenes, options)
        except PeerError as problem:
            print(problem, file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
