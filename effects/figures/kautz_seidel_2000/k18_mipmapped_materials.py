"""K18: a plane of brushed, bumpy metal out to the horizon, its material textures mip-mapped in three ways."""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import REPEATED, show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, material_textures
from fixedpipe.effects.texture_filtering import mipmapped_materials
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.state import Sampler

DATA = figure_data(__file__, "K18")

TRILINEAR = Sampler(
    TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR, WrapMode.REPEAT, WrapMode.REPEAT
)
FILTERS = {
    "vectors": mipmapped_materials.vectors,
    "covariance": mipmapped_materials.covariance_fit,
    "fit": mipmapped_materials.lobe_fit,
}


def _metal(size, *, bumps, depth, height_field=None, height_scale=0.0, **strokes):
    """Brushed, bumpy metal: of noise, or of a height field."""
    if height_field is None:
        return material_textures.gold(size=size, bumps=bumps, depth=depth, **strokes)
    slopes = height_field.slopes(size, height_scale, repeated=True)
    return material_textures.brushed_bumps(*slopes, **strokes)


@lru_cache(maxsize=2)
def _levels(filtering, **material):
    return FILTERS[filtering](_metal(**material))


def _gold(map_size, bumps, slope, alpha_x, alpha_y, spread, stroke_depth, k_s, **own):
    return {
        "size": map_size,
        "bumps": bumps,
        "depth": slope,
        "alpha_x": alpha_x,
        "alpha_y": alpha_y,
        "spread": spread,
        "stroke_depth": stroke_depth,
        "k_s": k_s,
        **own,
    }


def _camera(panel, pitch, field_of_view, length):
    """An eye at height one above the near edge of the plane y = 0, that looks down by ``pitch`` degrees."""
    drop = round(math.tan(math.radians(pitch)), 6)
    near_edge = length / 2.0
    return perspective_view(
        panel, (0.0, 1.0, near_edge), (0.0, 1.0 - drop, near_edge - 1.0), field_of_view, radius=1.5 * length
    )


def _plane(width, length, repeat):
    """The plane y = 0 round the origin, its vertices the denser the nearer they are to the eye's place.

    By cubes: the halfway vector turns fastest just below the eye, and is interpolated between vertices.
    """
    flat = surfaces.plane(16, 24)
    s, t = (flat.texture_coordinates[:, k] for k in (0, 1))
    across, along = width * (2.0 * s - 1.0) * (2.0 * s - 1.0) * (2.0 * s - 1.0), length * (t * t * t)
    surface = replace(
        flat,
        positions=np.stack([across, along - length / 2.0, 0.0 * s], axis=-1),
        texture_coordinates=np.stack([across + width, along], axis=-1) / repeat,
    )
    return surface.rotated(rotation("x", -90.0))


def _magnified(values, factor):
    """A repeated texture [rows, columns, ...] filtered bilinearly to ``factor`` times its edges."""
    for axis in (0, 1):
        values = np.moveaxis(values, axis, 0)
        parts = []
        for k in range(factor):
            at = (k + 0.5) / factor - 0.5
            other = np.roll(values, -1 if at > 0.0 else 1, axis=0)
            parts.append(values * (1.0 - abs(at)) + other * abs(at))
        values = np.stack(parts, axis=1).reshape(-1, *values.shape[1:])
        values = np.moveaxis(values, 0, axis)
    return values


@lru_cache(maxsize=4)
def reference(edge, pitch, field_of_view, width, length, repeat, light, **material):
    """The plane at many points per pixel: (n.l)+, Eq. 1, and how much of each pixel it covers: three float64
    [edge, edge], bottom row first.

    The points lie on the surface that the machine's level 0 describes, with vectors interpolated between
    texels. Nothing is rounded, and only the results are filtered.
    """
    gold, factor = _metal(**material), 4
    fields = np.concatenate(
        [gold.scaled_tangents, gold.scaled_binormals, gold.normals, gold.k_s[..., None]], axis=-1
    )
    fields = _magnified(fields, factor)
    texels = len(fields)
    view = _camera(row_of_panels(1, edge)[0], pitch, field_of_view, length)
    side, above, backward = (np.array(row[:3]) for row in view.modelview[:3])
    spread = 1.0 / view.projection[1][1]
    out = np.zeros((3, edge, edge))
    for row in range(edge):
        # Points per pixel: the nearer the horizon the more texels are under it, most of them along the view.
        middle = above * ((2.0 * row + 1.0) / edge - 1.0) * spread - backward
        distance = -1.0 / middle[1] if middle[1] < 0.0 else np.inf
        under = min(distance, length) ** 2 * 2.0 * spread / edge * (material["size"] / repeat)
        down, across = next(d for d in (8, 16, 32, 64) if d >= min(2.0 * under, 64.0)), 4
        y = ((row + (np.arange(down) + 0.5) / down) / edge * 2.0 - 1.0) * spread
        # Every row of points is moved by another fraction, so that they do not keep step with the texels.
        moved = np.mod(np.arange(down) * 0.618, 1.0)[:, None, None]
        x = np.arange(edge)[None, :, None] + (np.arange(across) + moved) / across
        x = (x / edge * 2.0 - 1.0) * spread
        ray = x[..., None] * side + y[:, None, None, None] * above - backward
        t = -1.0 / np.where(ray[..., 1] < 0.0, ray[..., 1], -1e-9)
        place = t[..., None] * ray  # from the point on the plane below the eye
        inside = (np.abs(place[..., 0]) < width) & (place[..., 2] > -length)
        u, v = (place[..., 0] + width) / repeat, -place[..., 2] / repeat
        i, j = (np.floor((w - np.floor(w)) * texels).astype(np.int64) for w in (u, v))
        values = fields[np.minimum(j, texels - 1), np.minimum(i, texels - 1)]
        half = normalize(np.array(light) - normalize(ray))
        # The surface's frame: t = +x, b = -z, n = +y.
        half, toward = (
            np.stack([w[..., 0], -w[..., 2], w[..., 1]], axis=-1) for w in (half, np.array(light))
        )
        a, b = dot(values[..., 0:3], half), dot(values[..., 3:6], half)
        specular = values[..., 9] * np.maximum(0.0, (1.0 - a * a) - b * b)
        diffuse = np.maximum(0.0, dot(values[..., 6:9], toward))
        for k, value in enumerate((diffuse, specular, 1.0)):
            value = np.where(inside, value, 0.0).transpose(1, 0, 2).reshape(edge, -1)
            out[k, row] = mipmapped_materials.total(value) / (down * across)
    return out


def scene(
    profile, size, *, filtering, map_size, bumps, slope, alpha_x, alpha_y, spread, stroke_depth, k_s, pitch,
    field_of_view, width, length, repeat, light, diffuse, ambient, specular, background,
    anisotropy, height_field, height_scale,
):  # fmt: skip
    """K18: a panel for each of ``filtering``, "none" or keys of FILTERS; then the reference, as a picture.

    ``anisotropy``: EXT_texture_filter_anisotropic's, for machines alone: the ideal has none.
    """
    own = {"height_field": height_field, "height_scale": height_scale}
    gold = _gold(map_size, bumps, slope, alpha_x, alpha_y, spread, stroke_depth, k_s, **own)
    *panels, last = row_of_panels(len(filtering) + 1, size)
    surface = _plane(width, length, repeat)
    toward = tuple(normalize(np.array(light)))
    out = []
    for panel, name in zip(panels, filtering, strict=True):
        levels = _levels("vectors", **gold)[:1] if name == "none" else _levels(name, **gold)
        sampler = REPEATED if name == "none" else replace(TRILINEAR, max_anisotropy=anisotropy)
        view = _camera(panel, pitch, field_of_view, length)
        loading, names = mipmapped_materials.load(levels, f"gold filtered by {name}", profile)
        out += (
            panel.clear(background),
            *loading,
            *diffuse_bump.diffuse_pass(
                surface, names.normal, view, Light(toward), profile, color=diffuse, ambient=ambient,
                sampler=sampler,
            ),
            *anisotropic_blinn_phong.specular_pass(
                surface, names, view, Light(toward), profile, specular=specular, gated=False, sampler=sampler
            ),
        )  # fmt: skip
    lit, highlight, covered = (
        part[..., None]
        for part in reference(size, pitch, field_of_view, width, length, repeat, toward, **gold)
    )
    picture = lit * np.array(diffuse) + covered * np.array(ambient) + highlight * np.array(specular)
    picture = np.clip(picture + (1.0 - covered) * np.array(background), 0.0, 1.0)
    return (
        *out,
        last.clear(background),
        *show(factor_texels(picture, profile), last, "supersampled image", surfaces.plane()),
    )


def _split(error, filled):
    """Root mean squares of an error's means over blocks of 16 x 16 pixels, its bias, and of what is left, its
    noise: over the ``filled`` pixels of the blocks that are at least half filled.
    """
    blocks = [size // 16 for size in error.shape]

    def sums(values):
        return values.reshape(blocks[0], 16, blocks[1], 16).sum(axis=(1, 3))

    count = sums(filled)
    mean = sums(np.where(filled, error, 0.0)) / np.maximum(count, 1)
    rest = error - mean.repeat(16, axis=0).repeat(16, axis=1)
    return root_mean_square(mean[count >= 128]), root_mean_square(rest[filled])


def _near(p, size):
    """Where the plane's texels are wider than pixels: bool [size, size]. Then its pixels there by Eq. 1 in
    float64, and with one of the material's fields flat each: [1 + fields, n, 3].
    """
    view = _camera(row_of_panels(1, size)[0], p["pitch"], p["field_of_view"], p["length"])
    origins, along = primary_rays(view)
    down = np.minimum(along[:, 1], -1e-12)
    places = origins - (origins[:, 1] / down)[:, None] * along
    away = places - np.array(view.eye)
    square = (away * away).sum(axis=-1)
    # A pixel's length on the plane, along the view.
    pixel = 2.0 * np.tan(np.radians(0.5 * p["field_of_view"])) / size * square
    where = (along[:, 1] < 0.0) & (pixel < 0.8 * p["repeat"] / p["map_size"])
    s, t = (places[where, 0] + p["width"]) / p["repeat"], (0.5 * p["length"] - places[where, 2]) / p["repeat"]
    frame = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    seen = seen_places.Seen(where, s, t, np.broadcast_to(frame, (len(s), 3, 3)))
    toward = seen_places.unit(np.array(p["light"]))
    half = seen_places.unit(toward - seen_places.unit(away[where])) @ frame.T
    names = ("map_size", "bumps", "slope", "alpha_x", "alpha_y", "spread", "stroke_depth", "k_s")
    fields = material_reference.fields(_metal(**_gold(*(p[name] for name in names))))

    def picture(fields):
        n, t, b = (seen_places.looked_up(fields[name], seen) for name in ("normals", "tangents", "binormals"))
        lost = (t[:, :3] * half).sum(axis=-1) ** 2 + (b * half).sum(axis=-1) ** 2
        parts = (
            (np.maximum(n @ (frame @ toward), 0.0), "diffuse"),
            (t[:, 3] * np.maximum(1.0 - lost, 0.0), "specular"),
        )
        light = sum(part[:, None] * np.array(p[name]) for part, name in parts)
        return np.clip(light + np.array(p["ambient"]), 0.0, 1.0)

    flat = {name: np.broadcast_to(field.mean(axis=(0, 1)), field.shape) for name, field in fields.items()}
    others = (picture({**fields, name: flat[name]}) for name in fields)
    return where.reshape(size, size), np.stack([picture(fields), *others])


def _displayed_checks(figure, renderer):
    """The near plane of every displayed panel beside planes without one of the material's fields."""
    where, found = _near(figure.values, figure.size)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        panels = [panel_of(window, k)[where] for k in range(figure.columns)]
        yield DATA.check(
            "near: of what a field of the material changes, the least share that is seen",
            min(material_reference.least_share(panel, *found) for panel in panels),
            on,
        )


def checks(figure, renderer):
    """The highlight's errors against the reference, over the pixels that the plane fills."""
    yield from _displayed_checks(figure, renderer)
    size, images = 256, {}
    p = figure.values
    names = ("map_size", "bumps", "slope", "alpha_x", "alpha_y", "spread", "stroke_depth", "k_s")
    camera = (p[name] for name in ("pitch", "field_of_view", "width", "length", "repeat"))
    toward = tuple(normalize(np.array(p["light"])))
    _, highlight, covered = reference(size, *camera, toward, **_gold(*(p[name] for name in names)))
    filled = covered == 1.0
    for on in Answer:
        image = renderer.window(on, figure, size, **DARK, specular=(1.0, 1.0, 1.0))[..., 0]
        parts = {name: image[:, k * size :][:, :size] for k, name in enumerate(p["filtering"])}
        images[on] = parts["fit"]
        rms = {name: root_mean_square((part - highlight)[filled]) for name, part in parts.items()}
        split = {name: _split(part - highlight, filled) for name, part in parts.items()}
        (_, noise), (bias_vectors, noise_vectors), (bias_fit, noise_fit) = split.values()
        measured = "; measured at the first correct picture, with a third of the distance to one as slack"
        for name, value, bound, reason in (
            (
                "RMS against the reference, fitted material textures / no mip-maps",
                rms["fit"] / rms["none"],
                0.86,
                "what the fit is for" + measured,
            ),
            (
                "RMS against the reference, fitted material textures / averaged vectors",
                rms["fit"] / rms["vectors"],
                0.74,
                "averaged vectors make a highlight as narrow as a single texel's" + measured,
            ),
            (
                "RMS of means over 16 x 16 pixels, fitted material textures / averaged vectors",
                bias_fit / bias_vectors,
                0.48,
                "the false highlight is gone" + measured,
            ),
            (
                "RMS about the means over 16 x 16 pixels, averaged vectors / no mip-maps",
                noise_vectors / noise,
                0.89,
                "any mip-maps take aliasing away" + measured,
            ),
            (
                "RMS about the means over 16 x 16 pixels, fitted material textures / no mip-maps",
                noise_fit / noise,
                0.84,
                "any mip-maps take aliasing away" + measured,
            ),
        ):
            yield Check(name, value, at_most=bound, on=on, reason=reason)
    yield DATA.check(
        "RMS of machine - ideal, fitted material textures",
        root_mean_square((images[Answer.MACHINE] - images[Answer.IDEAL])[filled]),
        Answer.MACHINE,
    )


FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "filtering": word.of(
            word.Several((word.Choice({name: name for name in ("none", *FILTERS)}),) * 3),
            ("none", "vectors", "fit"),
            "How each of the three panels' textures are made smaller: not at all, or one of the filters.",
        ),
        "map_size": word.TEXELS(128),
        "bumps": word.COUNT(10, "Bumps along an edge of the texture, about."),
        "slope": word.SLOPE(0.9, "The largest slope of the bumps, about."),
        "alpha_x": word.ALPHA_X(0.3),
        "alpha_y": word.ALPHA_Y(0.4),
        "spread": word.SPREAD(8.0),
        "stroke_depth": word.STROKE_DEPTH(0.15),
        "k_s": word.K_S((0.6, 1.0)),
        "pitch": word.DEGREES(15.0, "How far the viewer looks down at the plane.", low=0.0, high=80.0),
        "field_of_view": word.DEGREES(
            38.0, "The angle between the picture's lower and upper edge.", low=1.0, high=120.0
        ),
        "width": word.NUMBER(12.0, "Half the plane's width, over the eye's height.", low=1.0, high=64.0),
        "length": word.NUMBER(40.0, "The plane's length, over the eye's height.", low=1.0, high=128.0),
        "repeat": word.NUMBER(
            1.0, "The edge of the texture on the plane, over the eye's height.", low=0.125, high=16.0
        ),
        "light": word.LIGHT(
            (0.0, 0.42, -1.0),
            "The direction towards the light, of any length: x to the right, y up, z towards the near edge.",
        ),
        "diffuse": word.DIFFUSE((0.06, 0.12, 0.16)),
        "ambient": word.AMBIENT((0.02, 0.04, 0.06)),
        "specular": word.SPECULAR((0.92, 0.72, 0.50)),
        "background": word.BACKDROP(BACKGROUND),
        "anisotropy": word.NUMBER(
            1.0, "The most samples along a pixel's footprint, on machines that have them.", low=1.0, high=8.0
        ),
        "height_field": own_maps.height_field("the bumps"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05),
    },
    methods=(Method("register combiners", scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
