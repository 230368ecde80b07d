"""How one panel's picture differs from another's, sixteen times as large.

Both are copied into textures. Two general combiners subtract one from the other and multiply by four twice.
The final combiner adds the positive part of the difference and that of its negative.
"""

import numpy as np

from fixedpipe.effects.passes.combiners import (
    ONE,
    SPARE0,
    SPARE1,
    TEXTURE0,
    TEXTURE1,
    both,
    final,
    negated,
    product,
    program,
    scaled,
    signed,
    total,
)
from fixedpipe.effects.passes.draws import NEAREST, unit
from fixedpipe.pipeline.commands import CopyTexSubImage, Draw, TexImage
from fixedpipe.pipeline.state import PassState, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

# What two combiners multiply by.
TIMES = 16


def _padded(panel):
    """Columns and rows of a texture that holds a panel: the next powers of two."""
    return tuple(1 << (edge - 1).bit_length() for edge in (panel.width, panel.height))


def keep(panel, name):
    """Commands that make a panel's picture the texture ``name``, from its lower left corner on."""
    columns, rows = _padded(panel)
    return (
        TexImage(
            label=f"room for {name}", texture=name, image=texture_2d(np.zeros((rows, columns, 4), np.uint8))
        ),
        CopyTexSubImage(
            label=f"keep {name}",
            texture=name,
            x=panel.x,
            y=panel.y,
            width=panel.width,
            height=panel.height,
        ),
    )


def _combiners():
    """|texture 0 - texture 1|, ``TIMES`` as large, at most one."""
    difference = signed(SPARE0)
    return program(
        scaled(4, total(product(TEXTURE0, ONE), product(negated(TEXTURE1), ONE), to=SPARE0)),
        scaled(4, both(product(difference, ONE, to=SPARE0), product(negated(difference), ONE, to=SPARE1))),
        final(SPARE0, ONE, plus=SPARE1),
    )


def show_difference(first, second, panel, surface):
    """The command that shows on a panel the difference of two pictures that ``keep`` stored from panels of
    its size.

    ``surface``: a rectangle (``surfaces.plane``) of half width and half height one.
    """
    columns, rows = _padded(panel)
    scaled_to = surface.with_repeats(panel.width / columns, panel.height / rows)
    return Draw(
        label=f"{TIMES} |{first} - {second}|",
        mesh=scaled_to.mesh(),
        state=PassState(
            vertex=VertexState(viewport=panel.viewport),
            texture_units=(unit(first, NEAREST), unit(second, NEAREST)),
            register_combiners=_combiners(),
        ),
    )
