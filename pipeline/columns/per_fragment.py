"""Per-fragment operations in the column engine: tests, blending, and how a buffer stores a colour."""

import numpy as np

from fixedpipe.pipeline.enums import Clamp
from fixedpipe.pipeline.framebuffers.framebuffer import SURFACE_WORDS
from fixedpipe.raster import codes as C
from fixedpipe.raster.columns import numbers, per_fragment
from fixedpipe.raster.observer import unobserved


class _Surface:
    """How a buffer stores colours: masks of its components, and the colours that blending reads
    (section 10).
    """

    def __init__(self, framebuffer):
        keep, pad, self.alpha = SURFACE_WORDS[framebuffer.color_format]
        self.plain = (keep, pad, self.alpha) == (0xFFFFFFFF, 0, C.SURFACE_ALPHA_STORED)
        self.keep, self.pad = (
            np.array([word >> shift & 255 for shift in (0, 8, 16, 24)], np.int64) for word in (keep, pad)
        )

    def stored(self, color):
        """Colours as the buffer stores them."""
        if self.plain:
            return color
        if self.alpha == C.SURFACE_ALPHA_SEVEN_BITS:
            color = np.concatenate([color[:, :3], color[:, 3:] >> 1], axis=1)
        return (color & self.keep) | self.pad

    def padded(self, color):
        """The result of a logic operation as the buffer stores it."""
        return color if self.plain else (color & self.keep) | self.pad

    def source(self, color):
        """A fragment's colour as blending reads it."""
        return color if self.plain else color & (self.keep | np.array([0, 0, 0, 255]))

    def destination(self, color):
        """A stored colour as blending reads it."""
        if self.alpha == C.SURFACE_ALPHA_STORED:
            return color
        alpha = np.full_like(color[:, 3:], 255)
        if self.alpha == C.SURFACE_ALPHA_SEVEN_BITS:
            seven = color[:, 3:] & 127
            alpha = (seven << 1) | (seven >> 6)
        return np.concatenate([color[:, :3], alpha], axis=1)


def _written(state, source, stored, surface, bits, clamps, observe):
    """The result of blending or a logic operation on fragments and stored colours, before the color mask."""
    one, blending = numbers.one_of(bits), state.blending
    if state.logic_op is not None:
        source = surface.stored(np.clip(source, 0, one))
        return surface.padded(per_fragment.logic(state.logic_op, source, np.clip(stored, 0, one), one))
    if blending is not None:
        colors = surface.source(source), surface.destination(stored), numbers.fixed(blending.color, one)
        factors = blending.source, blending.destination
        source = per_fragment.blend(blending.equation, factors, *colors, bits)
        observe("blending", colors=colors, result=source)
    far = per_fragment.FAR
    return surface.stored(np.clip(source, *((0, one) if clamps else (-far, far))))


def write(fragments, color, state, profile, framebuffer, observe=unobserved):
    """Test and write fragments in draw order: bool [k], which passed.

    ``color``: int64 [k, 4] in the buffer's units; ``observe``: the observer.
    """
    bits, width = framebuffer.color_bits, framebuffer.width
    clamps = framebuffer.is_bytes or Clamp.BLENDING in profile.arithmetic.clamps
    surface = _Surface(framebuffer)
    stored = framebuffer.color.reshape(-1, 4)
    depth, stencil = framebuffer.depth.reshape(-1), framebuffer.stencil.reshape(-1)
    alive = fragments.depth >= 0
    if state.alpha_test is not None:
        reference = numbers.fixed(state.alpha_test.reference, numbers.one_of(bits))
        alive &= per_fragment.compare(state.alpha_test.function, color[:, 3], reference)
        observe(
            "alpha test", alpha=color[:, 3], reference=reference, inside=fragments.depth >= 0, passed=alive
        )
    mask = state.color_mask
    mask = np.array([mask.red, mask.green, mask.blue, mask.alpha])
    passed = np.zeros(len(alive), bool)
    living = np.flatnonzero(alive)
    pixel = fragments.y[living].astype(np.int64) * width + fragments.x[living]
    for once in per_fragment.in_order(pixel):
        at, here = pixel[once], living[once]
        observe("fragments", which=here)
        closer = np.ones(len(at), bool)
        if state.depth_test is not None:
            old = depth[at].astype(np.int64)
            closer = per_fragment.compare(state.depth_test.function, fragments.depth[here], old)
            observe("depth test", depth=fragments.depth[here], stored=old, passed=closer)
        if state.stencil_test is not None:
            closer = _stencil(state.stencil_test, stencil, at, closer, observe)
        at, here = at[closer], here[closer]
        passed[here] = True
        if state.depth_test is not None and state.depth_test.write:
            depth[at] = fragments.depth[here]
        if mask.any():
            old = stored[at].astype(np.int64)
            new = _written(state, color[here], old, surface, bits, clamps, observe)
            stored[at] = np.where(mask, new, old)
            observe("write", which=here, source=color[here], stored=old, result=new, mask=mask)
    return passed


def _stencil(test, stencil, at, closer, observe):
    """Stencil test and operation on fragments of distinct pixels. Returns which pass both tests."""
    stored, reference = stencil[at].astype(np.int64), min(max(test.reference, 0), 255)
    agreed = per_fragment.compare(test.function, np.int64(reference & test.mask), stored & test.mask)
    results = [
        per_fragment.stencil_result(operation, stored, reference)
        for operation in (test.depth_pass, test.depth_fail, test.fail)
    ]
    new = np.where(agreed, np.where(closer, results[0], results[1]), results[2])
    stencil[at] = (stored & ~test.write_mask) | (new & test.write_mask)
    observe(
        "stencil test", reference=reference, stored=stored, agreed=agreed, result=new, written=stencil[at]
    )
    return agreed & closer
