<<<<<<< HEAD
"""F002-2: one of the textures S_i of the triangular height field, and the field."""
=======
"""F002-2: one visibility texture of ridges, as a machine stores it, and the ridges."""
>>>>>>> 09ebe4b (F002-2: one visibility texture of ridges as machines store it, and what it leads to)

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
<<<<<<< HEAD
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.relief import lit_relief, oblique_view, relief
from fixedpipe.effects.geometry.vectors import dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import ADD, NEAREST, REPLACE, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.passes.pixel_texture_copies import float_image, texture_format
from fixedpipe.effects.scattering import height_field, visibility
from fixedpipe.effects.scattering.visibility import BACK
from fixedpipe.effects.scattering.visibility_textures import coordinates, texels_seen
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction, PrimitiveType
from fixedpipe.pipeline.state import AlphaTest, PassState, VertexState, Viewport
from fixedpipe.pipeline.textures.images import texture_2d

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

    Coordinates are of the texture in which light is looked up, twice as wide and high as the field, so that
    all are below one half: drawn twice they fill the range.
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
        vertex=VertexState(viewport=Viewport(left.x, left.y, left.width, left.height)),
        texture_units=units,
        scissor=left.scissor,
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
    """Where a ray from a texel first is below the field, in texels (x, y), by small steps; None where it
    leaves.

    ``steps``: to a texel. Raises nothing: a ray that stays level is followed for ``longest`` edges.
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
    """What is stored, read back from the picture, against rays that take small steps."""
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
        yield Check(
            "texels whose picture does not lead to what is seen",
            int((back != np.maximum(seen, -1)).sum()),
            at_most=0,
            on=on,
            reason="codes are read back without error, and where none is seen nothing is drawn",
        )
    agree, apart, turned = _agreement(field, np.where(seen == BACK, -1, seen), direction)
    yield Check(
        "share of texels that see something, or nothing, as rays in small steps say",
        agree,
        at_least=1.0,
        on=Answer.IDEAL,
        reason="every texel",
    )
    yield Check(
        "distance from where a ray ends to the texel that is stored, along an axis, in texels, at most",
        apart,
        at_most=0.5 + 1.0 / 32.0,
        on=Answer.IDEAL,
        reason="the nearest texel is half a texel away; the ray's steps are a 64th",
    )
    yield Check(
        "angle between d_i and the way to that texel, in angles of a texel at its distance, at most",
        turned,
        at_most=1.5,
        on=Answer.IDEAL,
        reason="the catalogue's bound",
    )
    yield Check(
        "share of texels that see another",
        float((seen >= 0).mean()),
        at_least=0.2,
        on=Answer.IDEAL,
        reason="one flank of two sees the other where it is low enough",
    )
=======
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.diagrams.drawing import INK, VISIBLE
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.relief import oblique_view, relief
from fixedpipe.effects.geometry.height_fields import texel_centers
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, NEAREST, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.passes.pixel_texture_copies import texture_format
from fixedpipe.effects.scattering.height_field import ridges
from fixedpipe.effects.scattering.visibility import BACK, precompute
from fixedpipe.effects.scattering.visibility_textures import coordinates, looked_up_size
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.state import AlphaTest
from fixedpipe.pipeline.textures.images import texture_2d

STORED, OWN = "S_i", "the texels' own coordinates"
EYE = (0.0, -3.0, 3.5)
BLACK = (0.0, 0.0, 0.0)
_SEEN = AlphaTest(ComparisonFunction.GREATER, 0.5)
# How bright a flank is that faces away from the direction; the other is 1.
_AWAY = 0.45


@lru_cache(maxsize=8)
def _ridges(texels, count, angle, direction):
    """The ridges, and what their texels see along one direction."""
    field = ridges(texels, texels, angle, count)
    return field, precompute(field, np.array([direction]))


def edge_of(size, texels):
    """The field's edge in texels: no more than a panel's pixels, and a multiple of what two ridges need."""
    return min(texels, size) // 4 * 4


def stored(seen, bits):
    """S_i as RGBA in [0, 1], [rows, columns, 4]: coordinates in red and green; alpha is 0 where none is
    seen.
    """
    out = np.zeros((*seen.shape, 4))
    out[..., :2] = coordinates(seen, bits) / ((1 << bits) - 1.0)
    out[..., 3] = seen >= 0
    return out


def _padded(values, bits):
    """A field's texels in a texture whose edges are powers of two, and begin again there."""
    more = [(0, looked_up_size(edge, bits) - edge) for edge in values.shape[:2]]
    return np.pad(values, (*more, (0, 0)), mode="wrap")


def _loaded(name, values, bits):
    """Codes are whole numbers of ``bits``; the ideal has them too, for codes are what is stored."""
    values = _padded(values, bits)
    if bits == 8:
        image = texture_2d(np.floor(values * 255.0 + 0.5).astype(np.uint8))
    else:
        image = texture_2d(values, texture_format(bits))
    return TexImage(label=f"load {name}", texture=name, image=image)


def _own_coordinates(field, seen, bits):
    """Colours of the texels' own coordinates, darker where a flank faces away: [rows, columns, 3]."""
    columns, rows = (looked_up_size(edge, bits) for edge in (field.columns, field.rows))
    s, t = texel_centers(field.columns, field.rows)
    out = np.zeros((field.rows, field.columns, 3))
    out[..., 0], out[..., 1] = s * field.columns / columns, t * field.rows / rows
    return out * np.where(seen == BACK, _AWAY, 1.0)[..., None]


def examples(seen, shown):
    """Texels (row, column) whose rays are drawn: some of those that see another, spread over rows and
    columns.
    """
    out = []
    rows = seen.shape[0]
    for k in range(shown):
        row = (2 * k + 1) * rows // (2 * shown)
        hits = np.flatnonzero(seen[row] >= 0)
        # Within the square, so that the whole ray is seen.
        ahead = [c for c in hits if seen[row, c] % seen.shape[1] > c and seen[row, c] // seen.shape[1] >= row]
        if ahead:
            out.append((row, ahead[(3 * k + 2) % max(1, len(ahead) * 2 // 3)]))
    return out


def _place(field, texel):
    row, column = texel
    return np.array(
        (
            2.0 * (column + 0.5) / field.columns - 1.0,
            2.0 * (row + 0.5) / field.rows - 1.0,
            2.0 * field.heights[row, column],
        )
    )


def scene(profile, size, *, texels, ridges, angle, direction, bits, rays):
    """S_i over a panel, a texel a square; and the field, each texel in the colour of its coordinates."""
    edge = edge_of(size, texels)
    field, visibility = _ridges(edge, ridges, angle, tuple(direction))
    seen = visibility.seen[0]
    left, right = row_of_panels(2, size)
    flat, view = drawing.sheet(left), oblique_view(right, EYE)
    own = texture_2d(factor_texels(_padded(_own_coordinates(field, seen, bits), bits), profile))
    surface = relief(field)
    share = edge / looked_up_size(edge, bits)
    surface = replace(surface, texture_coordinates=surface.texture_coordinates * share)
    arrows = [
        drawing.arrow(
            f"from texel {column}, {row} along d_i",
            view,
            np.stack([_place(field, (row, column)), _place(field, divmod(int(seen[row, column]), edge))]),
            INK,
            width=2.2,
            depth_test=VISIBLE,
        )
        for row, column in examples(seen, rays)
    ]
    return (
        left.clear(BLACK),
        _loaded(STORED, stored(seen, bits), bits),
        draw(
            "S_i: black where none is seen",
            plane().with_repeats(share, share).mesh(),
            flat,
            None,
            (unit(STORED, NEAREST, environment=REPLACE),),
            depth_test=None,
            alpha_test=_SEEN,
        ),
        right.clear(BACKGROUND),
        TexImage(label=f"load {OWN}", texture=OWN, image=own),
        draw(
            "the height field, coloured by its coordinates",
            surface.mesh(),
            view,
            None,
            (unit(OWN, NEAREST, environment=REPLACE),),
            depth_test=FIRST_PASS,
        ),
        *arrows,
    )


# ---------------------------------------------------------------------------------------------- checks


def _heights_at(values, x, angle):
    """The height of endless ridges at x, in texels: a triangle wave, from its equation."""
    period = values["edge"] / values["ridges"]
    share = x / period - np.floor(x / period)
    # Between the texels beside a crest or a valley the field is level.
    share = np.clip(np.minimum(share, 1.0 - share), 0.5 / period, 0.5 - 0.5 / period)
    return share * period * np.tan(np.radians(angle))


def _read(picture, edge):
    """Red and green in the middle of every texel of a square picture, [edge, edge, 2], bottom row first."""
    at = np.floor((np.arange(edge) + 0.5) / edge * len(picture)).astype(int)
    return picture[np.ix_(at, at)][..., :2]


def measured(picture, values):
    """What the catalogue asks, of coordinates that are read from the picture: degrees that a hit's direction
    deviates over what 1.5 texels are, the deepest that a segment to a hit lies below the field in texels,
    misses that do not escape, and the largest error of a coordinate in texels.
    """
    edge, bits, angle = values["edge"], values["bits"], values["angle"]
    size = looked_up_size(edge, bits)
    direction = normalize(np.array(values["direction"]))
    read = _read(picture, edge)
    hit = read.max(axis=-1) > 0.0
    decoded = np.minimum(np.floor(read * size + 1e-6), size - 1.0)
    error = np.abs(read * size - (decoded + 0.5))[hit].max()
    rows, columns = np.nonzero(hit)
    start = np.stack([columns + 0.5, rows + 0.5, _heights_at(values, columns + 0.5, angle)], axis=-1)
    q = decoded[hit] + 0.5
    z = _heights_at(values, q[:, 0], angle)
    # Of all tiles' copies of q the one that is nearest to the ray.
    deviation, steps = np.full(len(q), np.inf), np.zeros((len(q), 3))
    for i in range(-2, 3):
        for j in range(-2, 3):
            step = np.stack([q[:, 0] + i * edge, q[:, 1] + j * edge, z], axis=-1) - start
            length = np.sqrt((step * step).sum(axis=1))
            along = (step * direction).sum(axis=1)
            aside = np.sqrt(np.maximum(length * length - along * along, 0.0))
            with np.errstate(divide="ignore", invalid="ignore"):
                angle_of = np.where(length > 0.0, np.arctan2(aside, along) / np.arctan2(1.5, length), np.inf)
            nearer = angle_of < deviation
            deviation, steps = np.where(nearer, angle_of, deviation), np.where(nearer[:, None], step, steps)
    depth = 0.0
    for share in np.arange(0.02, 0.99, 0.02):
        at = start + share * steps
        depth = max(depth, float((_heights_at(values, at[:, 0], angle) - at[:, 2]).max()))
    rows, columns = np.nonzero(~hit)
    low = np.stack([columns + 0.5, _heights_at(values, columns + 0.5, angle)], axis=-1)
    # A flank that faces away sees nothing; its slope is that of the triangle wave.
    share = low[:, 0] * values["ridges"] / edge % 1.0
    steep = np.where(share < 0.5, -1.0, 1.0) * np.tan(np.radians(angle))
    faces = steep * direction[0] + direction[2] > 0.0
    below = np.zeros(len(low), bool)
    for length in np.arange(0.25, 3.0 * edge, 0.25):
        x, up = low[:, 0] + length * direction[0], low[:, 1] + length * direction[2]
        below |= up < _heights_at(values, x, angle) - 1e-9
    return float(deviation.max()), depth, int((below & faces).sum()), float(error), int(hit.sum())


def checks(figure, renderer):
    """The catalogue's, of what is read from the drawn picture."""
    method = renderer.method
    values = {name: parameter.default for name, parameter in figure.parameters_of(method).items()}
    size = figure.size // 2
    values["edge"] = edge_of(size, values["texels"])
    for on in Answer:
        picture = panel_of(renderer.window(on, figure, size), 0)
        deviation, depth, shut, error, hits = measured(picture, values)
        yield Check(
            "hits' directions: largest angle to d_i, over that of 1.5 texels",
            deviation,
            at_most=1.0,
            on=on,
            reason="the catalogue's: what is stored is a texel, not a point",
        )
        yield Check(
            "depth of the segments from p to q below the ridges' equation, in texels",
            depth,
            at_most=0.5,
            on=on,
            reason="free; q is its texel's centre, half a texel from the hit",
        )
        yield Check(
            "texels without a hit whose ray meets the ridges' equation",
            shut,
            at_most=0,
            on=on,
            reason="the catalogue's: misses do escape; flanks that face away see nothing",
        )
        yield Check(
            "coordinates' largest distance from their texels' centres, in texels",
            error,
            at_most=0.5,
            on=on,
            reason="the catalogue's: read back they lead to the texel that is seen",
        )
        yield Check(
            "share of texels that see another",
            hits / values["edge"] ** 2,
            at_least=0.3,
            on=on,
            reason="most of every flank that faces the direction; black would pass what is above",
        )
>>>>>>> 09ebe4b (F002-2: one visibility texture of ridges as machines store it, and what it leads to)


FIGURE = Figure(
    id="F002-2",
<<<<<<< HEAD
    title="Which texel is seen: a visibility texture",
    caption="S_i of the triangular height field: for every texel the coordinates of the texel that it sees "
    "along d_i, s in red and t in green, twice as bright; black where it sees none. Beside it the field.",
    must_see="Stripes along the ridges: black where a flank looks away or sees over the next ridge, else "
    "red that steps from ridge to ridge and green that grows upwards.",
    source="HeidrichDaubertKautzSeidel2000",
    techniques=("G01", "G02"),
    panels=("S_i", "the height field"),
    parameters={
        "texels": word.TEXELS(32, "The edge of the height field.", low=8, high=128),
        "ridges": word.of(word.Whole(1, 4), 4, "How many ridges there are."),
        "flank": word.DEGREES(45.0, "How steep the ridges' flanks are.", low=5.0, high=80.0),
        "direction": word.of(word.DIRECTION_KIND, (0.7, 0.35, 0.1), "d_i, along which texels look."),
        "bits": word.of(
            word.Choice({"8": 8, "12": 12}),
            8,
            "Of a coordinate: 8, or 12 where a machine has such textures, as the Octane.",
            "bits",
        ),
    },
    methods=(Method("a texture", scene, ("OCTANE", "GEFORCE_256", "OPENGL_1_2", "GEFORCE_3", "G400")),),
=======
    title="A visibility texture",
    caption=(
        "For one direction d_i, to the right and up in the picture, the texel that is seen from each texel "
        "of ridges: red and green are its coordinates, black is where none is seen. Beside it the ridges, "
        "every texel in the colour of its own coordinates, flanks that face away darker; arrows go from "
        "texels along d_i to those whose coordinates they hold."
    ),
    must_see=(
        "The ridges: upright stripes, of each one flank in the red of the next ridge's flank, the other "
        "black; green grows upwards, and begins again where the next tile is seen. Where an arrow begins, "
        "the left picture has the colour of where it ends."
    ),
    source="HeidrichDaubertKautzSeidel2000",
    techniques=("G01", "G02"),
    panels=("S_i as it is stored", "the height field"),
    parameters={
        "texels": word.of(word.Whole(4, 127), 60, "The height field's edge, at most.", "texels"),
        "ridges": word.of(word.Whole(1, 2), 2, "Ridges along an edge."),
        "angle": word.DEGREES(45.0, "How steep the flanks are.", low=5.0, high=80.0),
        "direction": word.of(word.DIRECTION_KIND, (0.85, 0.40, 0.12), "The direction d_i."),
        "bits": word.of(word.Whole(8, 12, even=True), 8, "Of a coordinate."),
        "rays": word.of(word.Whole(0, 12), 4, "Rays that are drawn over the height field."),
    },
    methods=(
        Method("coordinates of 8 bits", scene, ("OCTANE", "GEFORCE_256", "OPENGL_1_2")),
        Method("coordinates of 12 bits", scene, ("INFINITE_REALITY",), {"bits": 12}),
    ),
>>>>>>> 09ebe4b (F002-2: one visibility texture of ridges as machines store it, and what it leads to)
    acceptance=checks,
)
