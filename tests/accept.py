"""Accept a figure's digest: ``make accept FIGURE=ID PROFILE=NAME``, and ``LOOKED=yes`` once the picture was
looked at.

A digest says only that bits did not change. So one is accepted only when the executable specification gives
the same bits for a small picture of the same scene, and when someone has seen that it shows what it must.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

from effects.cli.files import png, write_whole
from effects.figures import FIGURES
from pipeline.execute import execute
from pipeline.golden import GOLDEN_SIZE, Golden, digest, from_text, to_text
from pipeline.profiles import PROFILES
from tests.run_reference import run_reference

REFERENCE_SIZE = 48  # edge of a panel, pixels: plain Python takes seconds for it
GOLDEN = Path(__file__).parent / "golden"
PICTURES = Path(__file__).parents[1] / "out" / "accept"
PAGES = Path(__file__).parents[1] / "docs"


def golden_path(figure_id, machine):
    return GOLDEN / f"{figure_id}-{machine}.json"


def page_picture(figure_id, machine):
    """Where the documentation keeps the figure's picture, at the digests' size; it may have none."""
    return PAGES / "images" / f"{figure_id}-{machine}.png"


def is_shown(path):
    """Whether a page of the documentation shows the picture."""
    return any(f"images/{path.name}" in page.read_text() for page in PAGES.rglob("*.md"))


def render(figure, machine):
    """The figure's colours on a machine at the digests' size: uint8 [h, w, 4]."""
    profile = PROFILES[machine]
    commands = figure.commands(profile, GOLDEN_SIZE, figure.method(machine))
    return execute(commands, profile, *figure.dimensions(GOLDEN_SIZE)).image()


def golden_of(figure, machine, color):
    width, height = figure.dimensions(GOLDEN_SIZE)
    return Golden(
        figure=figure.id, profile=machine, size=GOLDEN_SIZE, width=width, height=height, sha256=digest(color)
    )


def differences_from_reference(figure, machine, size=REFERENCE_SIZE):
    """How many values of colour, depth and stencil differ between the kernels and the specification."""
    profile, dimensions = PROFILES[machine], figure.dimensions(size)
    commands = figure.commands(profile, size, figure.method(machine))
    machine = execute(commands, profile, *dimensions).framebuffer
    target = run_reference(commands, profile, *dimensions, machine.depth_bits).target
    return sum(
        int((getattr(machine, name) != np.array(getattr(target, name))).sum())
        for name in ("color", "depth", "stencil")
    )


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Accept a figure's digest.")
    parser.add_argument("figure", metavar="ID")
    parser.add_argument("profile", metavar="NAME", nargs="?", help="machine; otherwise the figure's own")
    parser.add_argument("--looked", action="store_true", help="the picture was looked at beside its must-see")
    options = parser.parse_args(arguments)
    if options.figure not in FIGURES:
        print(f"There is no figure {options.figure!r}. There are: {', '.join(FIGURES)}.", file=sys.stderr)
        return 2
    figure = FIGURES[options.figure]
    machine = options.profile or figure.machines[0]
    try:
        figure.method(machine)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 2
    path = golden_path(figure.id, machine)
    golden = golden_of(figure, machine, color := render(figure, machine))
    if path.is_file() and from_text(path.read_text()) == golden:
        print(f"{figure.id}: the accepted digest is already this one.")
        return 0

    began = time.perf_counter()
    width, height = figure.dimensions(REFERENCE_SIZE)
    different = differences_from_reference(figure, machine)
    spent = time.perf_counter() - began
    if different:
        print(
            f"{figure.id} is refused: {different} values differ from the specification at {width}x{height}.",
            file=sys.stderr,
        )
        return 1
    print(f"{figure.id}: kernels and specification agree in every value at {width}x{height} ({spent:.0f} s).")

    PICTURES.mkdir(parents=True, exist_ok=True)
    picture = PICTURES / f"{figure.id}-{machine}.png"
    write_whole(picture, png(color))
    if not options.looked:
        print(f"Look at {picture}. It must show: {figure.must_see}")
        print(f"If it does: make accept FIGURE={figure.id} PROFILE={machine} LOOKED=yes")
        return 1
    write_whole(path, to_text(golden).encode())
    if is_shown(page := page_picture(figure.id, machine)):
        write_whole(page, png(color))
    print(f"Accepted {golden.sha256}.")
    print("Say why the bits changed in CHANGELOG.md, in a line that begins `Bits:`.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
