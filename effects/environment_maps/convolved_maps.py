"""H32: the machine itself filters an environment map in every frame, while it copies it.

    1. the surroundings are drawn into the framebuffer as a parabolic map's disc, alpha one in the disc
    2. CopyTexImage2D filters it with the imaging subset's convolution, a kernel of 11 x 11 texels
    3. the reflected vectors look the resulting texture up (``reflections.parabolic_passes``)

The kernel is Phong's lobe, cos^e of the angle between two texels. A texel at the disc's middle covers twice
the angle of one at the edge, but the kernel is the same everywhere. It is made for the texels half-way, so
reflections are a third too broad in the middle and a third too narrow at the edge. Eleven texels bound the
exponent: for maps of 64 texels, the least is about 100.

The lobe is nearly a product of two functions, so the separable filter is enough: 22 products a texel in place
of 121.

Source: Heidrich 2001, section 1.6; Kautz, Vazquez, Heidrich, Seidel 2000 (filtering by hardware); OpenGL
1.2.1, section 3.6.5; pass sequence A-H32 of the catalogue. Assumed: the lobe as the kernel, and where it is
right.
"""

from functools import reduce
from operator import add

import numpy as np

from fixedpipe.effects.environment_maps import reflections
from fixedpipe.effects.geometry import parabolic_maps, surfaces
from fixedpipe.effects.geometry.vectors import cosine
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, unit
from fixedpipe.effects.technique import Technique
from fixedpipe.pipeline.commands import CopyTexImage, Draw
from fixedpipe.pipeline.enums import BaseFormat, ConvolutionBorderMode
from fixedpipe.pipeline.pixel_transfer import ConvolutionFilter, PixelTransfer, SeparableFilter
from fixedpipe.pipeline.state import PassState, VertexState, Viewport

TECHNIQUES = (Technique("H32", "an environment map filtered for every frame by hardware convolution", "1.6"),)

# Source: Heidrich 2001, through the catalogue's A-H32; it is also what profiles have as the largest.
KERNEL = 11
# Texels around a disc, so that no kernel of a texel in it reaches the map's edge.
MARGIN = KERNEL // 2 + 1
# The angle of a step in the disc, in radians for a half edge, where r^2 = 1/2: 2/(1 + r^2).
_ANGLE = 4.0 / 3.0
# Powers differ in their last bit between processors: weights are rounded to this.
_WEIGHT_STEP = 2.0**-20


def _lobe(distances, exponent, size):
    """cos^e for distances in texels of a disc's map ``size`` texels wide, rounded."""
    angle = distances * (2.0 / size / parabolic_maps.margin(size, MARGIN) * _ANGLE)
    weights = np.maximum(cosine(np.minimum(angle, 1.5)), 0.0) ** exponent
    return np.floor(weights / _WEIGHT_STEP + 0.5) * _WEIGHT_STEP


def _colors(weights):
    return tuple((w, w, w, w) for w in weights.tolist())


def separable_filter(exponent, size):
    """The lobe as a row times a column of 11 weights each, which sum to one."""
    weights = _lobe(np.abs(np.arange(KERNEL) - KERNEL // 2), exponent, size)
    row = _colors(weights / reduce(add, weights.tolist()))
    return SeparableFilter(row, row, BaseFormat.RGB, ConvolutionBorderMode.REPLICATE_BORDER)


def general_filter(exponent, size):
    """The lobe as 11 x 11 weights, which sum to one."""
    x, y = np.meshgrid(*(np.arange(KERNEL) - KERNEL // 2,) * 2)
    weights = _lobe(np.sqrt(x * x + y * y), exponent, size)
    rows = tuple(_colors(row) for row in weights / reduce(add, weights.ravel().tolist()))
    return ConvolutionFilter(rows, BaseFormat.RGB, ConvolutionBorderMode.REPLICATE_BORDER)


def transfer_of(kernel):
    """The pixel transfer that applies either filter."""
    if isinstance(kernel, SeparableFilter):
        return PixelTransfer(separable_2d=kernel)
    return PixelTransfer(convolution_2d=kernel)


def load(names, discs, profile):
    """The commands that load discs [2, n, n, 3] with ``MARGIN`` texels around them."""
    return reflections.load_discs(names, discs, profile, MARGIN)


def filtered_copies(sources, names, size, kernel):
    """Commands that draw each disc into the window's lower left corner, ``size`` pixels wide, and copy it
    through a filter into a texture of another name. They overwrite that corner.
    """
    out = []
    for source, name in zip(sources, names, strict=True):
        state = PassState(
            vertex=VertexState(viewport=Viewport(0, 0, size, size)),
            texture_units=(unit(source, NEAREST, environment=REPLACE),),
        )
        copy = CopyTexImage(
            label=f"copy {source} through the convolution",
            texture=name,
            width=size,
            height=size,
            transfer=transfer_of(kernel),
        )
        out += (Draw(label=f"draw {source}", mesh=surfaces.plane().mesh(), state=state), copy)
    return tuple(out)
