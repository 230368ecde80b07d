"""Redraw cases through the ordinary pipeline and count the pixels that agree with the captures."""

import re
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules

import numpy as np

from fixedpipe.effects.conformance import suites
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, MissingInput, Shows, Suite
from fixedpipe.pipeline.enums import TexelWord
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.textures.words import texels_of_words

TEXT = (255, 255, 255, 0)  # what the processor wrote over the picture


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """One capture beside its redrawing. ``ours`` None: the case is not covered, and ``note`` says why.

    ``theirs``, ``ours`` uint8 [HEIGHT, WIDTH, 4]; ``compared``, ``equal`` bool [HEIGHT, WIDTH]. ``failed``:
    it should be covered, but something went wrong. A covered case's note is its explanation.
    """

    suite: str
    name: str
    theirs: np.ndarray
    ours: np.ndarray | None = None
    compared: np.ndarray | None = None
    equal: np.ndarray | None = None
    note: str = ""
    failed: bool = False

    @property
    def covered(self):
        """Whether the case was redrawn."""
        return self.ours is not None

    @property
    def pixels_compared(self):
        """How many pixels were compared."""
        return int(self.compared.sum()) if self.covered else 0

    @property
    def pixels_equal(self):
        """How many of them agree in all four components."""
        return int((self.equal & self.compared).sum()) if self.covered else 0

    @property
    def exact(self):
        """Whether every compared pixel agrees."""
        return self.covered and self.pixels_compared > 0 and self.pixels_equal == self.pixels_compared


def module_name(suite):
    """The name of a suite's module: its words in lower case, one that begins with a digit last."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", suite).lower().split("_")
    return "_".join(words[1:] + words[:1] if words[0][0].isdigit() else words)


def known_suites():
    """Every Suite by its name, as the modules of ``suites`` have it.

    Raises ValueError for a module that says no suite, or is not named as its suite, so no two can claim one.
    """
    found = {}
    for name in (m.name for m in iter_modules(suites.__path__)):
        module = import_module(f"{suites.__name__}.{name}")
        if not hasattr(module, "SUITE"):
            raise ValueError(
                f"{name}.py lies among the suites and has no SUITE; give it the name of its captures' "
                "folder, or move what suites share to effects/conformance/."
            )
        if module_name(module.SUITE) != name:
            raise ValueError(
                f"{name}.py says that it is {module.SUITE}; call it {module_name(module.SUITE)}.py, or give "
                "it its own suite's name."
            )
        found[module.SUITE] = Suite(name=module.SUITE, cases=module.CASES, open=getattr(module, "OPEN", ""))
    return found


def zeta_colors(framebuffer):
    """The depth buffer as the captures show it: 16-bit words as R5G6B5, depth and stencil as A8R8G8B8.

    5 bits become a byte by ``floor(255 v / 31)``; of 6 bits the upper and lower three do, each by ``floor(255
    v / 63)``. So do SDL's tables, with which the programs wrote the files. Measured: all of the 32 and 64
    values (DepthFmt_z16 captures).
    """
    depth, out = framebuffer.depth, np.empty((*framebuffer.depth.shape, 4), np.uint8)
    if framebuffer.depth_bits == 16:
        out[..., 0], out[..., 2] = (depth >> 11) * 255 // 31, (depth & 31) * 255 // 31
        out[..., 1] = ((depth >> 5) & 56) * 255 // 63 + ((depth >> 5) & 7) * 255 // 63
        out[..., 3] = 255
        return out
    out[..., 3], out[..., 0], out[..., 1] = depth >> 16, (depth >> 8) & 255, depth & 255
    out[..., 2] = framebuffer.stencil
    return out


def compare(suite, known, name, theirs, inputs, threads=None, profile=NV2A):
    """Redraw one case on a machine and compare it with its capture ``theirs``, uint8 [HEIGHT, WIDTH, 4].

    ``suite``: its name; ``known``: the Suite, None if it is not redrawn yet.
    """
    given = {"suite": suite, "name": name, "theirs": theirs}
    try:
        case = known.case(name, inputs) if known is not None else None
    except MissingInput as missing:
        return Comparison(**given, note=str(missing))
    if case is None:
        note = "the suite has no such case" if known is not None else "the suite is not covered"
        return Comparison(**given, note=note)
    framebuffer = execute(
        case.commands, profile, WIDTH, HEIGHT, depth_bits=case.depth_bits, threads=threads
    ).framebuffer
    ours = {
        Shows.COLOR: Framebuffer.image,
        Shows.ZETA: zeta_colors,
        Shows.ZETA_TEXTURE: lambda b: texels_of_words(b.depth, TexelWord.R5G6B5),
    }[case.shows](framebuffer)
    compared = case.compared()
    if case.shows != Shows.ZETA:  # nothing writes over a depth buffer
        compared &= (theirs != TEXT).any(-1)
    return Comparison(
        **given,
        ours=ours,
        compared=compared,
        equal=(ours == theirs).all(-1),
        # What a suite leaves open is said of each of its cases that is not exact and gives no reason itself.
        note=case.explanation or known.open,
    )
