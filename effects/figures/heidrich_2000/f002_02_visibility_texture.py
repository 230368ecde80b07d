"""F002-2: one of the textures S_i of the triangular height field, and the field."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.relief import lit_relief, oblique_view
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import ADD, NEAREST, REPLACE, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.passes.pixel_texture_copies import float_image, texture_format
from fixedpipe.effects.scattering import height_field, visibility
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.visibility import BACK
from fixedpipe.effects.scattering.visibility_textures import coordinates, texels_seen
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import AlphaTest, PassState, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F002-2")

RED, WHITE = (0.75, 0.14, 0.10), (0.8, 0.8, 0.8)
# Towards the light of the field's picture.
_LIGHT = (0.0, -0.45, 0.9)
_EYE = (1.0, -2.9, 2.7)


@lru_cache(maxsize=8)
def _seen(texels, ridges, flank, direction):
    """The height field, and what its texels see along the direction."""
    field = height_field.ridges(texels, texels, flank, ridges, left=WHITE, right=RED)
    return field, visibility.precompute(field, [direction]).seen[0]


def scene(profile, size, *, texels, ridges, flank, direction, bits):
    """S_i, its coordinates as red and green; the field from the side.

    The coordinates address the texture in which light is looked up. It is twice as wide and high as the
    field, so all coordinates are below one half, and are drawn twice as bright to fill the range.
    """
    left, right = row_of_panels(2, size)
    field, seen = _seen(texels, ridges, flank, direction)
    stored = coordinates(seen, bits) / float((1 << bits) - 1)
    image = np.zeros((texels, texels, 3))
    image[..., :2] = stored
    mask = (seen >= 0).astype(np.float64)
    units = (unit("S_i", NEAREST, environment=REPLACE),)
    square = Mesh(
        np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]),
        PrimitiveType.QUADS,
        texture_coordinates=(np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),),
    )
    state = PassState(
        vertex=VertexState(viewport=left.viewport),
        texture_units=units,
        alpha_test=AlphaTest(ComparisonFunction.GREATER, 0.5),
    )
    light = unit_vector(_LIGHT, "The light's direction")
    lit = field.albedo * (0.15 + 0.85 * np.maximum(dot(field.normals, light), 0.0))[..., None]
    return (
        left.clear((0.0, 0.0, 0.0)),
        right.clear(BACKGROUND),
        TexImage(
            label="load S_i: s, t, and whether a texel is seen",
            texture="S_i",
            pixels=float_image(image, mask),
            internal_format=texture_format(bits),
        ),
        TexImage(label="load the field", texture="field", image=texture_2d(factor_texels(lit, profile))),
        Draw(label="S_i, its coordinates as red and green", mesh=square, state=state),
        Draw(label="and again, twice as bright", mesh=square, state=replace(state, blending=ADD)),
        lit_relief("the field", relief(field), oblique_view(right, _EYE), "field"),
    )


def height_at(heights, x, y):
    """The height of the field's triangles at places in texels [n], by planes through three corners each."""
    rows, columns = heights.shape
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    u, v = x - i, y - j
    low, right = heights[j % rows, i % columns], heights[j % rows, (i + 1) % columns]
    up, far = heights[(j + 1) % rows, i % columns], heights[(j + 1) % rows, (i + 1) % columns]
    return np.where(
        u >= v, low + u * (right - low) + v * (far - right), low + v * (up - low) + u * (far - up)
    )


def by_steps(heights, row, column, direction, steps=64, longest=3.0):
    """Where a ray from a texel is first below the field, in texels (x, y), found by small steps; None if it
    leaves.

    ``steps``: to a texel. A level ray is followed for ``longest`` edges.
    """
    rows, columns = heights.shape
    dx, dy, dz = direction[0] * columns, direction[1] * rows, direction[2]
    count = int(longest * steps * max(rows, columns))
    t = np.arange(1, count) / (steps * max(abs(dx), abs(dy)))
    above = heights[row, column] + t * dz - height_at(heights, column + t * dx, row + t * dy)
    below = np.flatnonzero(above < -1e-9)
    if not len(below):
        return None
    t = t[below[0]]
    return column + t * dx, row + t * dy


def _agreement(field, seen, direction):
    """By small steps: (share of texels for which both say whether something is seen, greatest distance in
    texels along an axis between where it is seen and the texel that stands for it, greatest angle between the
    direction and that to this texel, in angles of a texel).
    """
    rows, columns = seen.shape
    agree, apart, turned = 0, 0.0, 0.0
    for row in range(0, rows, 3):
        for column in range(columns):
            place = by_steps(field.heights, row, column, direction)
            facing = float(dot(field.normals[row, column], direction)) > 0.0
            expected = place is not None and facing
            found = seen[row, column] >= 0
            agree += expected == found
            if not (expected and found):
                continue
            q = np.array([seen[row, column] % columns, seen[row, column] // columns], np.float64)
            away = np.array(place) - q
            away -= np.array([columns, rows]) * np.floor(away / (columns, rows) + 0.5)
            apart = max(apart, float(np.abs(away).max()))
            # The texel's copy in the tile that the ray has reached.
            x, y = np.array(place) - away
            there = np.array([(x - column) / columns, (y - row) / rows, 0.0])
            there[2] = field.heights[int(q[1]), int(q[0])] - field.heights[row, column]
            length = float(np.sqrt(dot(there, there)))
            cosine = float(dot(there, direction)) / length
            angle = np.sqrt(max(0.0, 1.0 - cosine * cosine))
            turned = max(turned, angle / (1.0 / columns / length))
    return agree / (len(range(0, rows, 3)) * columns), apart, turned


def checks(figure, renderer):
    """The stored coordinates, read back from the picture, against rays that take small steps."""
    values = dict(figure.values_of(renderer.method))
    texels, size = values["texels"], 4 * values["texels"]
    direction = normalize(np.array(values["direction"], np.float64))
    field, seen = _seen(texels, values["ridges"], values["flank"], values["direction"])
    one = (1 << values["bits"]) - 1
    for on in Answer:
        picture = panel_of(renderer.window(on, figure, size), 0)[2::4, 2::4, :2]
        codes = np.floor(picture * one / 2.0 + 0.5).astype(np.int64)
        drawn = picture.max(axis=-1) > 0.0
        back = np.where(drawn, texels_seen(codes, texels, texels, values["bits"]), -1)
        yield DATA.check(
            "texels whose picture does not lead to what is seen",
            int((back != np.maximum(seen, -1)).sum()),
            on,
        )
    agree, apart, turned = _agreement(field, np.where(seen == BACK, -1, seen), direction)
    yield DATA.check(
        "share of texels that see something, or nothing, as rays in small steps say", agree, Answer.IDEAL
    )
    yield DATA.check(
        ("distance from where a ray ends to the texel that is stored, along an axis, in texels, at most"),
        apart,
        Answer.IDEAL,
        at_most=0.5 + 1.0 / 32.0,
    )
    yield DATA.check(
        ("angle between d_i and the way to that texel, in angles of a texel at its distance, at most"),
        turned,
        Answer.IDEAL,
    )
    yield DATA.check("share of texels that see another", float((seen >= 0).mean()), Answer.IDEAL)
    edge, toward = figure.size, normalize(np.array(_LIGHT))
    there = seen_places.surface(relief(field), oblique_view(Panel(0, 0, edge, edge), _EYE))
    lit = field.albedo * (0.15 + 0.85 * np.maximum(field.normals @ toward, 0.0))[..., None]
    true = {1: (there.where, seen_places.looked_up(lit, there))}
    for on, share in seen_places.shares_alike(figure, renderer, true):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.TEXELS(32, "The edge of the height field.", low=8, high=128),
        "ridges": word.of(word.Whole(1, 4), 4, "How many ridges there are."),
        "flank": word.DEGREES(45.0, "How steep the ridges' flanks are.", low=5.0, high=80.0),
        "direction": word.of(word.DIRECTION_KIND, (0.7, 0.35, 0.1), "Along which texels look: d_i."),
        "bits": word.of(
            word.Choice({"8": 8, "12": 12}),
            8,
            "Of a coordinate: 8, or 12 where a machine has such textures, as the Octane.",
            "bits",
        ),
    },
    methods=(Method("a texture", scene, ("OCTANE", "GEFORCE_256", "OPENGL_1_2", "GEFORCE_3", "G400")),),
    acceptance=checks,
)
