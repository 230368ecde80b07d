"""F001-9: a bump map's pyramid, which loses its bumps, and the pyramid of roughness, which stores their
deviation.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import roughness_pyramids as rough
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import vector_texels
from fixedpipe.effects.texture_filtering.mipmapped_materials import texture_of_levels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.state import Sampler

DATA = figure_data(__file__, "F001-9")

MACHINES = ("OPENGL_1_2", "TEXRAM", "GEFORCE_256", "GEFORCE_3", "NV2A")
BUMPS, ROUGHNESS = "bump pyramid", "roughness pyramid"
# Levels that are drawn beside and below level 0; what follows is too small to see.
SHOWN = 6
_GAP = 1.0 / 96.0
# How each level is read: a texel as it is.
_NEAREST = (
    TextureFilter.NEAREST_MIPMAP_NEAREST,
    TextureFilter.NEAREST,
    WrapMode.CLAMP_TO_EDGE,
    WrapMode.CLAMP_TO_EDGE,
)


def ground(edge):
    """Offsets of smooth ground and pebbles above, ripples across and aslant below: float64 [edge, edge, 2].

    Each quarter that is not smooth has slopes about as steep; between quarters there are no cliffs.
    """
    s, t = height_fields.texel_centers(edge, edge)
    zero = np.zeros((edge, edge))
    # Triangles of height have two slopes.
    across, aslant = (
        np.where(phase % 1.0 < 0.5, -0.5, 0.5) for phase in (edge / 6.0 * s, edge / 8.0 * (s + t))
    )
    along_s, along_t = height_fields.slopes(height_fields.pebbles(edge, edge, max(2, edge // 16 * 2), 7))
    mean = np.sqrt((along_s * along_s + along_t * along_t).mean())
    quarters = (
        ((t < 0.5) & (s < 0.5), (across, zero)),
        ((t < 0.5) & (s >= 0.5), (0.7 * aslant, 0.7 * aslant)),
        ((t >= 0.5) & (s >= 0.5), (-0.7 * along_s / mean, -0.7 * along_t / mean)),
    )
    out = np.zeros((edge, edge, 2))
    for here, offsets in quarters:
        out = np.where(here[..., None], np.stack(offsets, axis=-1), out)
    return np.clip(out, -1.5, 1.5)


@lru_cache(4)
def pyramids(edge, height_field, height_scale):
    """Both pyramids, and the numbers that are stored as one: (levels, largest offset, largest deviation)."""
    if height_field is None:
        levels = rough.pyramid(ground(edge))
    else:
        levels = rough.from_heights(height_field.fitted(edge, edge, height_scale, repeated=True))
    offset = max(float(np.abs(levels[0].offsets).max()), 2.0**-10)
    deviation = max(max(float(np.abs(level.deviations).max()) for level in levels), 2.0**-10)
    return levels, offset, deviation


def places():
    """Where the levels are drawn, x and y of the lower left corner and the edge, in edges of level 0."""
    yield 0.0, 0.0, 1.0
    top = 1.0
    for number in range(1, SHOWN):
        edge = 0.5**number
        yield 1.0 + _GAP, top - edge, edge
        top -= edge + _GAP


def _texels(level, name, offset, deviation, profile):
    """A level as a board stores it: offsets in two signed components, or D in three."""
    if name == BUMPS:
        f = np.concatenate([level.offsets / offset, np.ones((*level.offsets.shape[:2], 1))], axis=-1)
        return vector_texels(np.clip(f, -1.0, 1.0), profile)
    if profile.arithmetic.exact:
        d = level.deviations / deviation
        return np.stack([d[..., 0], (128.0 + 127.0 * d[..., 1]) / 255.0, d[..., 2]], axis=-1)
    return rough.deviation_bytes(level.deviations, deviation)


def scene(profile, size, *, height_field, height_scale, background):
    """F001-9: all levels of both, each by its own level of one texture."""
    edge = max(32, 1 << (size // 2).bit_length() - 1)
    levels, offset, deviation = pyramids(edge, height_field, height_scale)
    out, scale = [], 2.0 / (1.0 + 2.0 * _GAP)
    for panel, name in zip(row_of_panels(2, size, FIGURE.aspect), (BUMPS, ROUGHNESS), strict=True):
        images = [_texels(level, name, offset, deviation, profile) for level in levels]
        out += [
            TexImage(label=f"load the {name}", texture=name, image=texture_of_levels(images)),
            panel.clear(background),
        ]
        view = orthographic_view(panel)
        for number, (x, y, wide) in enumerate(places()):
            read = Sampler(*_NEAREST, min_lod=float(number), max_lod=float(number))
            half = 0.5 * wide * scale
            square = plane(1, 1, half, half).moved(
                (x + 0.5 * wide - 0.75) * scale, (y + 0.5 * wide - 0.5) * scale, 0.0
            )
            label, units = f"level {number} of the {name}", (unit(name, read, environment=REPLACE),)
            out.append(draw(label, square.mesh(), view, None, units, depth_test=FIRST_PASS))
    return tuple(out)


def checks(figure, renderer):
    """The recursion against all texels, D in bytes, and that the picture shows every level."""
    values = figure.values
    levels, _, deviation = pyramids(256, values["height_field"], values["height_scale"])
    worst, stored, finest = 0.0, 0.0, levels[0].offsets
    for level in levels[1:]:
        n = level.offsets.shape[0]
        blocks = finest.reshape(n, 256 // n, n, 256 // n, 2).swapaxes(1, 2).reshape(n, n, -1, 2)
        spread = rough.products(blocks - blocks.mean(axis=2, keepdims=True)).mean(axis=2)
        worst = max(worst, float(np.abs(level.covariance - spread).max()))
        codes = rough.deviation_bytes(level.deviations, deviation)
        read = rough.deviations_of_bytes(codes, deviation)
        stored = max(stored, float(np.abs(read - level.deviations).max()) / deviation)
    yield DATA.check("recursive K - the covariance of all texels covered, largest", worst, Answer.IDEAL)
    yield DATA.check("D in bytes - D, over the largest", stored, Answer.IDEAL, at_most=1.0 / 128.0)
    size = figure.size
    image = np.asarray(renderer.window(Answer.MACHINE, figure, size))
    yield DATA.check(
        "level 5 of the bumps: deviation of its colours over level 0's",
        _spread(image, size, 0, 5) / _spread(image, size, 0, 0),
        Answer.MACHINE,
    )
    yield DATA.check(
        "level 0 of the roughness: deviation of its colours", _spread(image, size, 1, 0), Answer.MACHINE
    )
    yield DATA.check(
        "level 5 of the roughness: deviation of its colours over level 1's",
        _spread(image, size, 1, 5) / _spread(image, size, 1, 1),
        Answer.MACHINE,
    )

    finest = levels[0].offsets
    colors = [_colors(finest, number) for number in range(SHOWN)]
    for on in Answer:
        image, shares = np.clip(renderer.window(on, figure, size), 0.0, 1.0), []
        for number, both in enumerate(colors):
            for panel, true in enumerate(both):
                box, column, row = _box(image, size, panel, number)
                there = [np.floor(part * len(true)).astype(int) for part in (row, column)]
                shares.append(seen_places.alike(box, true[np.ix_(*there)], seen_places.WITHIN))
        yield DATA.check(
            "a level's pixels with the texels' mean, or D of their covariance, within 8/255, the least",
            min(shares),
            on,
        )


def _box(image, size, panel, level):
    """A level's pixels, and at which share of its edge their columns and rows lie."""
    width = size * 3 // 2
    x, y, edge = list(places())[level]
    scale = size / (1.0 + 2.0 * _GAP)
    left, low = (0.5 * width + (x - 0.75) * scale, 0.5 * size + (y - 0.5) * scale)
    columns, rows = (np.arange(int(start) + 1, int(start + edge * scale) - 1) for start in (left, low))
    column, row = ((k + 0.5 - start) / (edge * scale) for k, start in ((columns, left), (rows, low)))
    return image[np.ix_(rows, panel * width + columns)], column, row


def _spread(image, size, panel, level):
    """The deviation of a level's colours as they are drawn."""
    box, _, _ = _box(image, size, panel, level)
    return float(box.reshape(-1, 3).std(axis=0).mean())


def _blocks(finest, number):
    """What a level's texels cover of level 0: the means, [n, n, 2], and D of the covariance, [n, n, 3]."""
    edge = len(finest) >> number
    parts = finest.reshape(edge, 1 << number, edge, 1 << number, 2)
    mean = parts.mean(axis=(1, 3))
    apart = parts - mean[:, None, :, None]
    (a, b), (_, c) = np.einsum("iujvk,iujvl->klij", apart, apart) / 4.0**number
    d_3 = np.sqrt(c)
    d_2 = np.divide(b, d_3, out=np.zeros_like(b), where=d_3 > 0.0)
    return mean, np.stack([np.sqrt(np.maximum(a - d_2 * d_2, 0.0)), d_2, d_3], axis=-1)


def _colors(finest, number):
    """A level of both pyramids as it is to look, from level 0 alone: float64 [n, n, 3] each."""
    largest = max(float(np.abs(_blocks(finest, k)[1]).max()) for k in range(len(finest).bit_length()))
    mean, d = _blocks(finest, number)
    offsets = np.concatenate([mean / np.abs(finest).max(), np.ones((*mean.shape[:2], 1))], axis=-1)
    d = d / largest
    return 0.5 + 0.5 * offsets, np.stack([d[..., 0], 0.5 + 0.5 * d[..., 1], d[..., 2]], axis=-1)


FIGURE = Figure(
    **DATA.words,
    panels=(BUMPS, ROUGHNESS),
    aspect=(3, 2),
    parameters={
        "height_field": own_maps.height_field("the ground"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("levels of textures", scene, MACHINES),),
    acceptance=checks,
)
