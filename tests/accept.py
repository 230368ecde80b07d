"""Accept a figure's digest: ``make accept FIGURE=ID PROFILE=NAME``, and ``LOOKED=yes`` once the picture was
looked at.

A digest says only that bits did not change. So one is accepted only when the executable specification gives
the same bits for a small picture of the same scene, and when someone has seen that it shows what it must.
Where another machine draws the same bits in the same way, what was done for its digest holds for this one.
The specification has frames of eight-bit machines; of a wider one a picture is compared with the ideal, where
every number has 16 bits.
"""

import argparse
import sys
import time
from functools import cache
from pathlib import Path

import numpy as np

from fixedpipe.effects.acceptance.precision import measure
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reports.files import write_whole
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.golden.digests import GOLDEN_SIZE, Golden, digest, from_text, to_text
from fixedpipe.pipeline.profiles import PROFILES
from tests.support.run_reference import run_reference

REFERENCE_SIZE = 32  # edge of a panel, pixels: plain Python takes a minute for ten thousand triangles
# RMS of (machine - ideal), 1.0 = full intensity, that a picture of a wider machine may have where every
# number has 16 bits, of the same stored textures and vertices. Measured: 0.0005 at most (F004-3); with the
# machine's own bytes in textures and framebuffer it is 0.001 to 0.005, where smaller faults would hide.
FROM_IDEAL = 1 / 1024
# Where formats of eight bits keep them beside wider ones, what passes define from pixels is rounded to bytes:
# half a byte more, at most (docs/numbers.md, section 13).
BYTES_KEPT = 0.5 / 255
GOLDEN = Path(__file__).parent / "golden"
PICTURES = Path(__file__).parents[1] / "out" / "accept"
PAGES = Path(__file__).parents[1] / "docs"


def golden_path(figure_id, machine):
    return GOLDEN / f"{figure_id}-{machine}.json"


def page_picture(figure_id, machine):
    """Where the documentation keeps the figure's picture, at the digests' size; it may have none."""
    return PAGES / "images" / f"{figure_id}-{machine}.png"


@cache
def _pages(folder):
    """The text of every page below a folder."""
    return "\n".join(page.read_text() for page in sorted(folder.rglob("*.md")))


def is_shown(path):
    """Whether a page of the documentation shows the picture."""
    return f"images/{path.name}" in _pages(PAGES)


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


def error_from_ideal(figure, machine, size=REFERENCE_SIZE):
    """RMS of (machine - ideal) of a small picture, both of the same stored textures and vertices, with 16
    bits everywhere: what is left is the order and the rounding of the arithmetic.
    """
    wide = dict.fromkeys(("combiner_bits", "texture_bits", "framebuffer_bits"), 16)
    return measure(figure, PROFILES[machine].with_precision(**wide), size, figure.method(machine)).shown


def loads_for_each_polygon(figure, method):
    """Whether a way of drawing a figure takes thousands of loads and Draws, and many seconds."""
    return method.name == "imaging subset" and figure.id in ("F004-4", "F004-5", "F004-6")


def is_specified(machine):
    """Whether the executable specification has whole frames of the machine: of colours of eight bits."""
    return (
        PROFILES[machine].arithmetic.combiner_bits == 8 and PROFILES[machine].framebuffers.color_bits[0] == 8
    )


def same_as(figure, machine, golden):
    """A machine whose digest was accepted, draws as this one does, and gives the same bits; or None."""
    for other in figure.method(machine).machines:
        path = golden_path(figure.id, other)
        if other != machine and path.is_file() and from_text(path.read_text()).sha256 == golden.sha256:
            return other
    return None


def problem(figure, machine, golden):
    """Why the digest cannot be accepted, or None; says what was found."""
    if other := same_as(figure, machine, golden):
        print(f"{figure.id}: the bits on {machine} are those accepted for {other}.")
        return None
    width, height = figure.dimensions(REFERENCE_SIZE)
    if not is_specified(machine):
        error, widened = error_from_ideal(figure, machine), f"{machine} with 16 bits"
        print(f"{figure.id}: RMS from the ideal on {widened} at {width}x{height}: {error:.5f}.")
        bound = FROM_IDEAL + BYTES_KEPT * (PROFILES[machine].arithmetic.texture_bits > 8)
        return None if error <= bound else f"that is more than {bound:.5f}"
    began = time.perf_counter()
    different = differences_from_reference(figure, machine)
    spent = time.perf_counter() - began
    if different:
        return f"{different} values differ from the specification at {width}x{height}"
    print(
        f"{figure.id}: {machine} and the specification agree in every value, {width}x{height} ({spent:.0f} s)"
    )
    return None


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

    if why := problem(figure, machine, golden):
        print(f"{figure.id} on {machine} is refused: {why}.", file=sys.stderr)
        return 1
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
