"""Material_color_source: nine quads whose lit colours take parts of their material from the vertices'
colours.

Each quad is cut into primary colour, secondary colour and their sum, and into its own alpha and an opaque
half. Source: src/tests/material_color_source_tests.cpp of nxdk_pgraph_tests.
"""

from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np

from fixedpipe.effects.conformance import lit_scenes, scenes
from fixedpipe.effects.conformance.case import Case
from fixedpipe.effects.passes.combiners import PRIMARY, SECONDARY, SPARE0, ZERO, program, shown, stage, total
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import ColorSource, PrimitiveType, SecondaryColor
from fixedpipe.pipeline.state import ColorSources, Lighting, Material

SUITE = "Material_color_source"

SOURCES = {
    "FromMaterial": ColorSource.MATERIAL,
    "FromVertexDiffuse": ColorSource.PRIMARY,
    "FromVertexSpecular": ColorSource.SECONDARY,
}
EMISSIONS = {"": 0.0, "_me0_15": 0.15, "_me0_5": 0.5, "_me1_0": 1.0}
LIGHTS = ("", "_2light")
EMISSIVE = {"Emissive_me0": 0.0, "Emissive_me0_15": 0.15, "Emissive_me0_5": 0.5, "Emissive_me1_0": 1.0}

VERTEX_DIFFUSE, VERTEX_SPECULAR = (0.1, 0.4, 0.1, 0.25), (0.4, 0.1, 0.1, 0.25)
SCENE_AMBIENT, ALPHA = (0.2, 0.2, 0.2), 0.75
AMBIENT, DIFFUSE, SPECULAR = (0.1, 0.1, 0.1), (0.0, 0.4, 0.0), (0.4, 0.0, 0.0)
EMISSIVE_COLOR = (0.0, 0.0, 0.4)
COEFFICIENTS = tuple(  # power 125
    np.array([0xBF78DF9C, 0xC04D3531, 0x404EFD4A, 0xBF71F52E, 0xC048FA21, 0x404C7CD6], np.uint32)
    .view(np.float32)
    .tolist()
)

# Which parts the nine quads take from the vertices' colour, row by row.
PARTS = (
    *(("diffuse",), ("diffuse", "specular"), ("specular",)),
    *(("diffuse", "emission"), ("diffuse", "specular", "emission", "ambient"), ("specular", "ambient")),
    *(("emission",), ("emission", "ambient"), ("ambient",)),
)
M, D, S = ColorSource.MATERIAL, ColorSource.PRIMARY, ColorSource.SECONDARY
EMISSIVE_PARTS = ((D, D), (S, D), (D, S), (S, S), (M, S), (S, M), (M, D), (D, M), (M, M))  # emission, ambient

LEFT, TOP, WIDTH, HEIGHT, GAP = 126.0, 100.0, 128.0, 96.0, 4.0  # pixels, of the quads
LEGEND = (
    *(VERTEX_DIFFUSE[:3], VERTEX_SPECULAR[:3], SCENE_AMBIENT, DIFFUSE),
    *(SPECULAR, EMISSIVE_COLOR, AMBIENT),
)
LEGEND_LEFT, LEGEND_TOP, LEGEND_RIGHT, LEGEND_STEP = 16.0, 120.0, 110.0, 25.0


def _combiners(primary, secondary, opaque):
    both = total(PRIMARY if primary else ZERO, SECONDARY if secondary else ZERO, to=SPARE0)
    shows = shown(SPARE0) if opaque else shown(SPARE0, alpha=SPARE0)
    return program(stage(both, alpha=both), shows)


def _quad(label, box, state, color, secondary=None):
    points = [scenes.unprojected(*corner) for corner in scenes.rectangle(*box)]
    arrays = {"colors": scenes.single([color] * 4)}
    if secondary is not None:
        arrays["secondary_colors"] = scenes.single([secondary] * 4)
        arrays["normals"] = scenes.single([(0.0, 0.0, -1.0)] * 4)
    mesh = Mesh(scenes.single(points), PrimitiveType.QUADS, **arrays)
    return Draw(label=label, mesh=mesh, state=state)


def _lit_quad(place, lighting):
    """The six parts of a quad; ``place``: its number."""
    left, top = LEFT + (WIDTH + GAP) * (place % 3), TOP + (HEIGHT + GAP) * (place // 3)
    state = lit_scenes.state(lighting, secondary_color=SecondaryColor.FROM_VERTEX)
    for row, (primary, secondary) in enumerate(((True, False), (False, True), (True, True))):
        y = top + row * HEIGHT / 3
        for opaque in (False, True):
            x = left + WIDTH / 2 * opaque
            combined = replace(state, register_combiners=_combiners(primary, secondary, opaque))
            box = (x, y, x + WIDTH / 2, y + HEIGHT / 3)
            yield _quad(f"quad {place}", box, combined, VERTEX_DIFFUSE, VERTEX_SPECULAR)


def _legend():
    state = replace(
        scenes.DEFAULT, vertex=scenes.xdk_vertex(), register_combiners=_combiners(True, False, False)
    )
    for row, color in enumerate(LEGEND):
        y = LEGEND_TOP + row * LEGEND_STEP
        yield _quad("legend", (LEGEND_LEFT, y, LEGEND_RIGHT, y + LEGEND_STEP), state, (*color, 1.0))


def _lighting(sources, lights, scene, emission):
    """``scene``, ``emission``: what the registers of those names hold.

    The chip starts from the scene's, plus the emission's times a vertex colour that takes the emission's or
    the ambient colour's place; where both places are taken, the emission's colour stands for the scene's.
    """
    white = lit_scenes.WHITE
    follows = sources.ambient != M
    given, factor = lit_scenes.color(scene), lit_scenes.color((emission,) * 3)
    if (sources.ambient, sources.emission) == (M, M):
        factor = lit_scenes.BLACK
    return Lighting(
        lights=lights,
        front=Material(
            white,
            (1.0, 1.0, 1.0, ALPHA),
            white,
            emission=given if follows else factor,
            specular_coefficients=COEFFICIENTS,
        ),
        model_ambient=factor if follows else given,
        separate_specular_color=True,
        front_sources=sources,
        viewer_direction=lit_scenes.EYE_DIRECTION,
    )


def _from_one(source, emission, second):
    """All parts of a quad that come from the vertices come from one colour."""
    scene = scenes.single([a + b for a, b in zip(SCENE_AMBIENT, EMISSIVE_COLOR, strict=True)])
    sources = [ColorSources(**dict.fromkeys(parts, source)) for parts in PARTS]
    return _quads(sources, scene, emission, [(0.25, 0.25, 0.25)] * second)


def _emissive(emission):
    sources = [ColorSources(emission=e, ambient=a) for e, a in EMISSIVE_PARTS]
    return _quads(sources, SCENE_AMBIENT, emission)


def _quads(sources, scene, emission, greys=()):
    """``greys``: the colours of the lights after the first."""
    colors = [(AMBIENT, DIFFUSE, SPECULAR), *((grey,) * 3 for grey in greys)]
    lights = tuple(lit_scenes.directional((0.0, 0.0, 1.0), **lit_scenes.colors(*each)) for each in colors)
    draws = [
        draw
        for place, each in enumerate(sources)
        for draw in _lit_quad(place, _lighting(each, lights, scene, emission))
    ]
    background = scenes.background(0xFF202020, 0xFF909090, 20)
    return Case(commands=(scenes.clear(0xFF303030), *background, *draws, *_legend()))


CASES = {
    f"{name}{emission}{lights}": partial(_from_one, source, value, bool(lights))
    for (name, source), (emission, value), lights in product(SOURCES.items(), EMISSIONS.items(), LIGHTS)
} | {name: partial(_emissive, emission) for name, emission in EMISSIVE.items()}
