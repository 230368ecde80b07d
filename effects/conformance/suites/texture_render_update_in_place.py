"""Texture_render_update_in_place: a white texture loses blue while it is drawn to, elsewhere red.

Source: src/tests/texture_render_update_in_place_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.conformance import scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import (
    CONSTANT0,
    CONSTANT1,
    SPARE0,
    TEXTURE0,
    product,
    program,
    shown,
    stage,
    total,
)
from fixedpipe.pipeline.commands import BindTexImage, Draw, MakeCurrent
from fixedpipe.pipeline.enums import WindowOrigin
from fixedpipe.pipeline.state import TextureUnit

SUITE = "Texture_render_update_in_place"

SIZE, EDGE, DEPTH = 256, 1.75, 0.1
WITHOUT_BLUE, WITHOUT_RED = (1.0, 1.0, 0.0), (0.0, 1.0, 1.0)


def _without(constant):
    """Combiners that multiply unit 0's texel with a colour."""
    rgb = total(product(TEXTURE0, CONSTANT0), to=SPARE0)
    alpha = total(product(TEXTURE0, CONSTANT1), to=SPARE0)
    given = {"constant0": constant, "constant1": (0.0, 0.0, 0.0)}
    return program(stage(rgb, alpha=alpha), shown(SPARE0, alpha=SPARE0), **given)


def _drawn(surface, source, constant):
    """A surface drawn from another's texture, or from itself."""
    state = replace(
        scenes.DEFAULT,
        texture_units=(TextureUnit(source, scenes.NEAREST),),
        register_combiners=_without(constant),
    )
    corners = scenes.rectangle(0, 0, SIZE, SIZE, DEPTH)
    mesh = scenes.window_mesh(corners, height=SIZE, texture_coordinates=(scenes.UNIT_SQUARE,))
    return (
        BindTexImage(label=source, texture=source, surface=source, origin=WindowOrigin.UPPER_LEFT),
        MakeCurrent(label=surface, surface=surface, width=SIZE, height=SIZE),
        Draw(label=surface, mesh=mesh, state=state),
    )


def _case():
    st = np.array(scenes.TWO_TRIANGLES, np.float64)
    square = scenes.textured_triangles([(EDGE * (2 * s - 1), EDGE * (1 - 2 * t), DEPTH) for s, t in st], st)
    state = replace(
        scenes.DEFAULT,
        vertex=scenes.xdk_vertex(),
        texture_units=(TextureUnit("second", scenes.NEAREST),),
        register_combiners=scenes.SHOWS_TEXTURE0,
    )
    white = scenes.quad("white", scenes.rectangle(0, 0, SIZE, SIZE, DEPTH), (1.0, 1.0, 1.0, 1.0), height=SIZE)
    return Case(
        commands=(
            MakeCurrent(label="first", surface="first", width=SIZE, height=SIZE),
            white,
            *_drawn("first", "first", WITHOUT_BLUE),
            *_drawn("second", "first", WITHOUT_RED),
            BindTexImage(label="second", texture="second", surface="second", origin=WindowOrigin.UPPER_LEFT),
            MakeCurrent(label="window"),
            scenes.clear(0xFE252525),
            Draw(label="square", mesh=square, state=state),
        )
    )


CASES = {"RenderToInputTexture": _case}
