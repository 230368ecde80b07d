"""F002-10: three bump-mapped spheres: shadows alone, scattered light as well, light from an environment as
well.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, Sampler, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import environment_light, height_field, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.pipeline.commands import Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter, WrapMode
from fixedpipe.pipeline.state import PassState, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F002-10")

HALF_HEIGHT = 1.12
# The texture of light is the half of the sphere that is seen, in stereographic projection: no pole lies in it
# and bumps keep their shape. A place n has the coordinates (n_x, n_y) / (1 + n_z) / REACH, from -1 to 1. The
# half's edge has 1 / REACH; what lies beyond is filtered with it.
REACH = 1.1
# Fields on an edge of the texture.
FIELDS = 4
_SAMPLES = 3
_FILTERED = Sampler(
    TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR, WrapMode.CLAMP_TO_EDGE, WrapMode.CLAMP_TO_EDGE
)
# The environment by height, straight down to straight up: brown earth, a bright horizon, a blue sky.
SKY = np.array(
    [
        *((0.36, 0.22, 0.12), (0.42, 0.27, 0.15), (0.48, 0.31, 0.18), (0.55, 0.38, 0.24)),
        *((0.52, 0.60, 0.70), (0.34, 0.52, 0.80), (0.22, 0.42, 0.84), (0.16, 0.34, 0.82)),
    ]
)
# The environment's brightness behind the spheres, beside that of what lights them.
_BEHIND = 1.2


@lru_cache(maxsize=4)
def _field(texels, stones, height, albedo, directions):
    """Stones that lie in the ground by a third."""
    heights = np.maximum(height_fields.pebbles(texels, texels, stones, 4) - 0.25 / stones, 0.0)
    field = height_field.height_field(height * height_fields.smooth(heights), albedo)
    return field, visibility.precompute(field, spiral(directions))


@lru_cache(maxsize=8)
def _tiles(texels, stones, height, albedo, directions, lookups):
    return environment_light.tiles(*_field(texels, stones, height, albedo, directions), lookups)


def _places(edge):
    """The normals at the texels of a texture of light, its tangents and binormals: three float64 [edge, edge,
    3].
    """
    at = REACH * (2.0 * (np.arange(edge) + 0.5) / edge - 1.0)
    x, y = np.meshgrid(at, at)
    square = x * x + y * y
    scale = 2.0 / (1.0 + square)
    normals = np.stack([scale * x, scale * y, (1.0 - square) / (1.0 + square)], axis=-1)
    tangents = np.stack([1.0 - x * scale * x, -x * scale * y, -scale * x], axis=-1)
    binormals = np.stack([-y * scale * x, 1.0 - y * scale * y, -scale * y], axis=-1)
    return normals, tangents, binormals


def coordinates_of(normals):
    """Texture coordinates of places on the visible half of the sphere; those of other places lie on the
    edge.
    """
    radius = np.maximum(1.0 + normals[..., 2], 1e-6)[..., None]
    at = normals[..., :2] / radius / REACH
    beyond = np.maximum(np.abs(at).max(axis=-1, keepdims=True), 1.0)
    return 0.5 + 0.5 * at / beyond


@lru_cache(maxsize=16)
def lights(texels, stones, height, albedo, directions, lookups, light, brightness):
    """Direct light, scattered light and the sky's on the sphere's half that is seen: three float64 [edge,
    edge, 3], and the height of every place's texel, [edge, edge].
    """
    field, seen = _field(texels, stones, height, albedo, directions)
    made = _tiles(texels, stones, height, albedo, directions, lookups)
    edge = FIELDS * texels
    normals, tangents, binormals = (axis.reshape(-1, 3) for axis in _places(edge))
    place = (np.arange(edge)[:, None] % texels) * texels + np.arange(edge)[None, :] % texels
    sun = unit_vector(light, "The light's direction")
    frames = tangents, binormals, normals
    found = environment_light.on_turning_base(field, seen, made, place.ravel(), frames, sun, brightness * SKY)
    return (*(one.reshape(edge, edge, 3) for one in found), field.heights.ravel()[place])


def _texels_of(size, texels):
    return min(texels, 16 if size < 100 else texels)


def _pictures(size, intensity, **values):
    """The three textures of light: with shadows alone, scattered light added, the sky's added."""
    values["texels"] = _texels_of(size, values["texels"])
    sun, scattered, sky, _ = lights(**values)
    return [intensity * light for light in (sun, sun + scattered, sun + scattered + sky)]


# Heights in a panel between which the environment's colours are mixed, and entries of SKY.
_HORIZON = ((-1.0, 2), (-0.1, 3), (-0.1, 4), (1.0, 7))


def _behind(panel, brightness):
    """The environment behind a sphere."""
    (bottom, low), (middle, below), (_, above), (top, high) = _HORIZON
    colors = [np.minimum(brightness * _BEHIND * SKY[k], 1.0) for k in (low, below, above, high)]
    corners = np.array(
        [
            place
            for under, over in ((bottom, middle), (middle, top))
            for place in ((-1.0, under), (1.0, under), (1.0, over), (-1.0, over))
        ]
    )
    mesh = Mesh(corners, PrimitiveType.QUADS, colors=np.repeat(np.stack(colors), 2, axis=0))
    state = PassState(vertex=VertexState(viewport=panel.viewport))
    return Draw(label="the environment behind it", mesh=mesh, state=state)


def scene(profile, size, *, intensity, brightness, background, **values):
    """The three spheres, a texture of light each."""
    panels = row_of_panels(3, size)
    pictures = _pictures(size, intensity, brightness=brightness, **values)
    ball = surfaces.sphere(24, 16) if size < 100 else surfaces.sphere(96, 64)
    mesh = ball.mesh(coordinates_of(ball.normals))
    names = ("direct light", "and scattered light", "and the environment's")
    out = []
    for name, picture in zip(names, pictures, strict=True):
        image = texture_2d(factor_texels(picture, profile), mipmaps=True)
        out.append(TexImage(label=f"load {name}", texture=name, image=image))
    for name, panel in zip(names, panels, strict=True):
        out += [panel.clear(background), _behind(panel, brightness)]
        units = (unit(name, _FILTERED, environment=REPLACE),)
        view = orthographic_view(panel, HALF_HEIGHT)
        out.append(draw(f"the sphere: {name}", mesh, view, None, units, depth_test=FIRST_PASS))
    return tuple(out)


def _looked_up(picture, s, t):
    """A picture [edge, edge, 3] between the middles of its texels: float64 [..., 3]."""
    edge, found = len(picture), 0.0
    x, y = (np.clip(place * edge - 0.5, 0.0, edge - 1.000001) for place in (s, t))
    i, j = x.astype(np.int64), y.astype(np.int64)
    u, v = (x - i)[..., None], (y - j)[..., None]
    for dj, below in ((0, 1.0 - v), (1, v)):
        for di, left in ((0, 1.0 - u), (1, u)):
            found = found + below * left * picture[j + dj, i + di]
    return found


def in_software(size, *, intensity, brightness, background, **values):
    """The same without triangles and mip maps: nine samples a pixel on a round sphere."""
    del background
    pictures = _pictures(size, intensity, brightness=brightness, **values)
    fine = _SAMPLES * size
    x, y = pixel_grid(fine, 1.0 / HALF_HEIGHT)
    inside = x * x + y * y < 1.0
    z = np.sqrt(np.where(inside, 1.0 - x * x - y * y, 1.0))
    s, t = (0.5 + 0.5 * place / (1.0 + z) / REACH for place in (x, y))
    height = np.linspace(-1.0, 1.0, fine + 1)[:-1] + 1.0 / fine
    above = height > _HORIZON[1][0]
    sky = np.stack(
        [
            np.where(above, *(np.interp(height, *pair) for pair in (
                ([h for h, _ in _HORIZON[2:]], [SKY[k, c] for _, k in _HORIZON[2:]]),
                ([h for h, _ in _HORIZON[:2]], [SKY[k, c] for _, k in _HORIZON[:2]]),
            )))
            for c in range(3)
        ],
        axis=-1,
    )  # fmt: skip
    behind = np.broadcast_to(np.minimum(brightness * _BEHIND * sky, 1.0)[:, None], (fine, fine, 3))
    out = np.ones((size, 3 * size, 4))
    for number, picture in enumerate(pictures):
        colors = np.where(inside[..., None], np.minimum(_looked_up(picture, s, t), 1.0), behind)
        mean = colors.reshape(size, _SAMPLES, size, _SAMPLES, 3).mean(axis=(1, 3))
        out[::-1, number * size : (number + 1) * size, :3] = mean
    return out


# What is as dark as this is black, and how far a place faces the sun from which only bumps can hide it.
_BLACK, _FACES = 4.0 / 255.0, 0.2


def _off_the_sun(bright, x, y, ball, sun):
    """Degrees by which the middle of a sphere's light lies beside the line from its centre to the sun."""
    middle = np.array([(bright * place)[ball].sum() for place in (x, y)])
    return float(np.degrees(np.arccos(middle @ sun[:2] / np.linalg.norm(middle) / np.linalg.norm(sun[:2]))))


def _displayed(figure, renderer, on):
    """What must be seen, sentence after sentence, in the picture that is displayed."""
    pictures = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
    first, second, third = (panel_of(pictures, k) for k in range(3))
    x, y = pixel_grid(figure.size, 1.0 / HALF_HEIGHT)
    square = x * x + y * y
    ball, inner = square < 0.98, square < 0.9
    sun = unit_vector(figure.values["light"], "The light's direction")
    for what, sphere in (("first", first), ("second", second)):
        off = _off_the_sun(sphere.mean(axis=-1), x, y, ball, sun)
        yield DATA.check("{what} sphere: degrees from the sun to the middle of its light", off, on, what=what)
    facing = (x * sun[0] + y * sun[1]) + np.sqrt(np.maximum(1.0 - square, 0.0)) * sun[2]
    black = first.max(axis=-1) <= _BLACK
    yield DATA.check("first sphere: the share of it that is black", float(black[ball].mean()), on)
    valleys = second[inner & (facing > _FACES) & black]
    yield DATA.check("second: what is black on the first though it faces the sun, mean", valleys.mean(), on)
    yield DATA.check(
        "third: the share of it that is black", float((third.max(axis=-1) <= _BLACK)[ball].mean()), on
    )
    albedo = np.array(figure.values["albedo"])
    whole = (third < 1.0).all(axis=-1) & inner & (np.abs(x) < 0.5)
    above, below = ((third - second)[whole & part].mean(axis=0) / albedo for part in (y > 0.5, y < -0.5))
    yield DATA.check(
        "what the environment adds above, over the albedo: blue over the larger of red and green",
        float(above[2] / above[:2].max()),
        on,
    )
    yield DATA.check(
        "what it adds below, over the albedo: red over the larger of green and blue",
        float(below[0] / below[1:].max()),
        on,
    )
    beside, high = (square > 1.05) & (np.abs(y) > 0.75 * HALF_HEIGHT), y > 0.0
    for what, sphere in (("first", first), ("second", second), ("third", third)):
        sky, earth = sphere[beside & high].mean(axis=0), sphere[beside & ~high].mean(axis=0)
        yield DATA.check("behind the {what}, above: blue over red", float(sky[2] / sky[0]), on, what=what)
        yield DATA.check("behind the {what}, below: red over blue", float(earth[0] / earth[2]), on, what=what)


def checks(figure, renderer):
    """The spheres' means, their valleys against their tops, the light of longer paths, and what must be
    seen.
    """
    size = figure.size // 2
    inside = (lambda x, y: x * x + y * y < 0.9)(*pixel_grid(size, 1.0 / HALF_HEIGHT))
    for on in Answer:
        means = [float(panel_of(renderer.window(on, figure, size), k)[inside].mean()) for k in range(3)]
        for k, what in enumerate(("scattered light adds", "the environment adds")):
            yield DATA.check(
                "what {what} to the mean of the sphere before", means[k + 1] / means[k] - 1.0, on, what=what
            )
    values = {k: v for k, v in figure.values.items() if k not in ("intensity", "background")}
    sun, scattered, _, height = lights(**values)
    lit = _places(len(height))[0] @ unit_vector(values["light"], "The light's direction") > 0.0
    low, high = np.quantile(height, (0.2, 0.8))
    valleys, tops = lit & (height <= low), lit & (height >= high)
    ratio = [light[valleys].mean() / light[tops].mean() for light in (sun, sun + scattered)]
    yield DATA.check(
        "valleys over tops with scattered light, over the same without",
        float(ratio[1] / ratio[0]),
        Answer.IDEAL,
    )
    short = lights(**{**values, "lookups": 1})[1]
    yield DATA.check(
        "change of the mean from paths of 2 reflections to paths of 4",
        float((sun + scattered).mean() / (sun + short).mean() - 1.0),
        Answer.IDEAL,
    )
    rays = in_software(size, **figure.values)[::-1, :, :3]
    apart = np.abs(np.clip(renderer.ideal_window(figure, size), 0.0, 1.0) - rays).max(axis=-1)
    yield DATA.check("median difference from the software renderer", float(np.median(apart)), Answer.IDEAL)
    for on in Answer:
        yield from _displayed(figure, renderer, on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.TEXELS(128, "The edge of the bump map.", low=8, high=256),
        "stones": word.EVEN(6, "Stones along an edge of the bump map."),
        "height": word.NUMBER(1.0, "How high the stones stand, 1 = balls.", low=0.1, high=2.0),
        "albedo": word.of(word.COLOR_KIND, (0.75, 0.75, 0.75), "The surface's albedo.", word.FULL),
        "directions": word.of(word.Whole(20, 1000), 100, "Directions along which visibility is known."),
        "lookups": word.of(word.Whole(0, 8), 3, "Lookups along a path: its reflections but one."),
        "light": word.LIGHT((-0.55, 0.6, 0.58)),
        "intensity": word.NUMBER(0.95, "The exposure.", low=0.0, high=4.0),
        "brightness": word.NUMBER(0.5, "The environment's, beside the light's.", low=0.0, high=4.0),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("textures of scattered light", scene, ("GEFORCE_256", "OPENGL_1_2", "OCTANE")),),
    acceptance=checks,
    reference=in_software,
)
