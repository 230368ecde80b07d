"""Accept the self-test's digests: ``make accept-selftest``, and ``LOOKED=yes`` once the picture was seen.

A digest is accepted where every engine on every number of threads gives the same bits, and where they are the
specification's, of every frame that ``tests/support/run_reference.py`` draws.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from fixedpipe.effects.reports.files import write_whole
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.selftest import digests
from fixedpipe.pipeline.selftest.checks import MOST_THREADS, draw, ways
from fixedpipe.pipeline.selftest.digests import digest_of, drawn_of
from fixedpipe.pipeline.selftest.frames import FRAMES
from tests.support.run_reference import run_reference

ACCEPTED = Path(digests.__file__).parent / digests.ACCEPTED
SHEET = Path(__file__).parents[1] / "out" / "accept" / "selftest.png"
# Frames of which the specification has no whole drawing, and what is known of their bits besides: that the
# engines agree.
UNSPECIFIED = {
    "histograms-and-convolved-reading": "the specification keeps no histogram",
    "twelve-bits": "the specification has single draws at other widths: tests/reference/render.py",
    "twelve-bits-of-the-octane": "likewise",
    "sixteen-bits": "likewise",
    "six-bits": "likewise",
    "samples": "the specification of samples has single pixels: tests/reference/multisample.py",
    "the-future-board": "the specification of the future board has functions: tests/reference/future.py",
}
_ACROSS, _GAP, _TIMES = 10, 4, 4  # frames side by side, pixels between them, how much a pixel is magnified


def specified(frame):
    """The Digest of what the specification draws of a frame."""
    depth_bits = frame.window.get("depth_bits", frame.profile.widest_depth)
    drawn = run_reference(frame.commands, frame.profile, *frame.size, depth_bits)
    read = {f"pixels {name}": values for name, values in drawn.pixels.items()}
    target = drawn.target
    return digest_of(frame, drawn_of(target.color, target.depth, target.stencil, read))


def drawn_alike(frame):
    """The Digest of what all engines draw of a frame, and the ways that give other bits than the first."""
    asked = ways(range(1, MOST_THREADS + 1))
    found = [digest_of(frame, draw(frame, way)) for way in asked]
    return found[0], [str(way) for way, one in zip(asked, found, strict=True) if one != found[0]]


def sheet():
    """All frames in one picture, uint8 [h, w, 4]."""
    images = [execute(f.commands, f.profile, *f.size, **f.window).image() for f in FRAMES]
    width = max(image.shape[1] for image in images) + _GAP
    rows = [images[k : k + _ACROSS] for k in range(0, len(images), _ACROSS)]
    heights = [max(image.shape[0] for image in row) + _GAP for row in rows]
    page = np.full((sum(heights), _ACROSS * width, 4), 255, np.uint8)
    for number, row in enumerate(rows):
        for column, image in enumerate(row):
            y, x = sum(heights[:number]), column * width
            page[y : y + image.shape[0], x : x + image.shape[1], :3] = image[..., :3]
    return page.repeat(_TIMES, 0).repeat(_TIMES, 1)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Accept the self-test's digests.")
    parser.add_argument("--looked", action="store_true", help="the picture of all frames was looked at")
    options = parser.parse_args(arguments)
    kept = []
    for frame in FRAMES:
        digest, others = drawn_alike(frame)
        if others:
            print(f"{frame.name} is refused: not the same bits by {'; '.join(others)}.", file=sys.stderr)
            return 1
        if frame.name not in UNSPECIFIED and specified(frame) != digest:
            print(f"{frame.name} is refused: its bits are not the specification's.", file=sys.stderr)
            return 1
        print(f"{frame.name}: {UNSPECIFIED.get(frame.name, 'as the specification draws it')}")
        kept.append(digest)
    text = digests.to_text(kept)
    if ACCEPTED.is_file() and ACCEPTED.read_text() == text:
        print("The accepted digests are already these.")
        return 0
    SHEET.parent.mkdir(parents=True, exist_ok=True)
    write_whole(SHEET, png(sheet()))
    if not options.looked:
        print(f"Look at {SHEET}: frame by frame, row by row, in the order above.")
        print("If each shows what its name says: make accept-selftest LOOKED=yes")
        return 1
    write_whole(ACCEPTED, text.encode())
    print(
        f"Accepted {len(kept)} digests. Say why bits changed in CHANGELOG.md, in a line that begins `Bits:`."
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
