"""H43: a ring of scales by Kilgard's two passes, with and without the normaliser, next to Blinn's in
float.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.bump_mapping import blinn, two_pass_bumps, vertex_program_vectors
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vertex_vectors import half_vectors, light_vectors
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_texels
from fixedpipe.effects.scattering.made_fields import scales
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "H43")

_EYE = (0.0, 0.0, 5.4)
_TILT = -52.0
_REPEATS = (6.0, 2.0)
# What of the parameters is the lighting.
_LIGHTING = ("color", "ambient", "specular", "exponent")


def _edge(size):
    """Texels of the map for panels of ``size`` pixels."""
    return min(256, max(32, 1 << (size // 2).bit_length() - 1))


@lru_cache(4)
def _map(edge, rows_of_scales, depth, own, scale):
    """Heights and colours of the ring's skin, one of its repeats: [edge, edge] and [edge, edge, 3]."""
    field = scales(edge, edge, rows_of_scales, depth)
    if own is None:
        return field.heights, field.albedo
    return own.fitted(edge, edge, scale, repeated=True), np.full((edge, edge, 3), 0.8)


def _ring(around, across):
    return surfaces.torus(around, across, radius=0.72, tube_radius=0.33).rotated(rotation("x", _TILT))


def _view(panel):
    return perspective_view(panel, _EYE, (0.0, 0.05, 0.0), 23.0, 1.6)


def _by_host(surface, view, light):
    return light_vectors(surface, light), half_vectors(surface, view, light)


def in_float(size, p):
    """The light of Blinn's bump mapping at texels of a texture that goes once around the ring: RGB [rows,
    columns, 3]; and the ring whose coordinates read it.
    """
    columns, rows = 2 * size, size
    heights, colors = _map(_edge(size), p["scales"], p["depth"], p["height_field"], p["height_scale"])
    fine = _ring(columns, rows)
    grid = (rows + 1, columns + 1)
    s, t = (fine.texture_coordinates[:, k].reshape(grid)[:-1, :-1] * _REPEATS[k] for k in range(2))
    light, view = Light(p["light"], point=True), _view(row_of_panels(1, size)[0])
    to_light, half = (
        v.reshape(*grid, 3)[:-1, :-1] for v in (light_vectors(fine, light), half_vectors(fine, view, light))
    )
    albedo = np.stack([blinn.interpolated(colors[..., k], s, t) for k in range(3)], axis=-1)
    settings = {name: p[name] for name in _LIGHTING}
    return blinn.radiance(blinn.normals(heights, s, t), to_light, half, albedo, **settings)


def _blinn_panel(profile, size, panel, p, surface):
    """The last panel: light computed at texels on the host, and a texture of it on the ring."""
    values = np.clip(in_float(size, p), 0.0, 1.0)
    rows, columns = values.shape[:2]
    # Vertices of the fine ring stand where this texture's centres are: half a texel further.
    mesh = surface.mesh(surface.texture_coordinates + np.array([0.5 / columns, 0.5 / rows]))
    image = texture_2d(factor_texels(values, profile))
    units = (unit("light in float", REPEATED, environment=REPLACE),)
    return (
        TexImage(label="load Blinn's light", texture="light in float", image=image),
        draw("Blinn's bumps, in float", mesh, _view(panel), None, units, depth_test=FIRST_PASS),
    )


def scene_by(vectors):
    """The scene with l and h by a function of surface, view and light."""

    def scene(profile, size, *, cube_map_size, around, across, background, **p):
        panels = row_of_panels(4, size)
        heights, colors = _map(_edge(size), p["scales"], p["depth"], p["height_field"], p["height_scale"])
        ring, light = _ring(around, across), Light(p["light"], point=True)
        mapped = ring.with_repeats(*_REPEATS)
        settings = {name: p[name] for name in _LIGHTING}
        out = [
            *(panel.clear(background) for panel in panels),
            *(
                TexImage(label=f"load the {name}", texture=name, image=texture_2d(texels))
                for name, texels in (
                    ("normals", vector_texels(blinn.normal_map(heights), profile)),
                    ("colours", factor_texels(colors, profile)),
                )
            ),
            *two_pass_bumps.load_normalizers(cube_map_size, profile, p["specular"], p["exponent"]),
        ]
        for number, normalized in ((0, True), (1, False), (2, True)):
            view = _view(panels[number])
            given = {**settings, "color_map": "colours" if number else None, "normalized": normalized}
            lit = mapped, vectors(mapped, view, light)
            passes = two_pass_bumps.lighting_passes(*lit, "normals", view, profile, **given)
            out += passes if number else passes[:1]
        return (*out, *_blinn_panel(profile, size, panels[3], p, _ring(2 * around, 2 * across)))

    return scene


def reference(size, *, cube_map_size, around, across, background, **p):
    """Blinn's bump mapping in float64 on a fine ring, which both ways of the vectors approximate."""
    (panel,) = row_of_panels(1, size)
    drawn = (panel.clear(background), *_blinn_panel(IDEAL, size, panel, p, _ring(192, 96)))
    picture = execute_ideal(drawn, size, size).color[..., :3]
    out = np.zeros((size, 4 * size, 4))
    for number in (1, 2, 3):
        out[:, number * size : (number + 1) * size, :3] = picture
        out[:, number * size : (number + 1) * size, 3] = 1.0
    return out


# ---------------------------------------------------------------------------------------------- checks


def _panels(figure, renderer, on, size, **changes):
    window = np.clip(renderer.window(on, figure, size, **changes), 0.0, 1.0)
    return [panel_of(window, k) for k in range(4)]


@lru_cache(4)
def _vectors_by_rays(around, across, size, lamp):
    """The Seen of a ring's pixels, and l and h there by those at the vertices: float64 [n, 3] each."""
    ring = _ring(around, across)
    view = _view(row_of_panels(1, size)[0])
    seen = seen_places.surface(ring, view)
    hits = RayCaster(ring.positions[ring.triangles]).nearest(*primary_rays(view), 1.0)
    at = seen.where.ravel()
    corners, weights = ring.triangles[hits.triangle[at]], hits.barycentrics[at][..., None]
    toward = seen_places.unit(np.array(lamp) - ring.positions)
    half = seen_places.unit(toward + seen_places.unit(np.array(_EYE) - ring.positions))
    frames = np.stack([ring.tangents, ring.binormals, ring.normals], axis=1)
    both = ((frames @ v[..., None])[..., 0] for v in (toward, half))
    return seen, *((v[corners] * weights).sum(axis=1) for v in both)


def _in_float64(p, size, number):
    """A panel's pixels in float64, then on a level skin, then of one colour, without highlights, and with
    vectors as long as another panel's: float64 [n, 3] each. Those come last that the panel has.
    """
    fine = 2 if number == 3 else 1
    seen, toward, half = _vectors_by_rays(fine * p["around"], fine * p["across"], size, tuple(p["light"]))
    seen = seen_places.Seen(seen.where, seen.s * _REPEATS[0], seen.t * _REPEATS[1], seen.frames)
    heights, albedo = _map(_edge(size), p["scales"], p["depth"], p["height_field"], p["height_scale"])
    normals, color = (seen_places.looked_up(field, seen) for field in (blinn.normal_map(heights), albedo))
    level, one_color = np.array([0.0, 0.0, 1.0]), color.mean(axis=0)

    def light(normals, color, shine, length):
        toward_lamp, halfway = (seen_places.unit(v) if length else v for v in (toward, half))
        shadow = np.clip(8.0 * toward_lamp[:, 2:], 0.0, 1.0)
        lit, bright = (np.maximum((normals * v).sum(axis=-1), 0.0)[:, None] for v in (toward_lamp, halfway))
        out = color * (lit * shadow * np.array(p["color"]) + np.array(p["ambient"]))
        return np.clip(out + shine * p["specular"] * shadow * bright ** p["exponent"], 0.0, 1.0)

    if number == 0:
        return seen.where, light(normals, 1.0, 0.0, True), light(level, 1.0, 0.0, True)
    length = number != 1
    return (
        seen.where,
        light(normals, color, 1.0, length),
        light(level, color, 1.0, length),
        light(normals, one_color, 1.0, length),
        light(normals, color, 0.0, length),
        *((light(normals, color, 1.0, not length),) if number < 3 else ()),
    )


def _displayed_checks(figure, renderer):
    """The displayed rings beside rings without scales, colours or highlights, or with the other vectors."""
    size, values = figure.size, figure.values_of(renderer.method)
    found = [_in_float64(values, size, number) for number in range(4)]
    for on in Answer:
        panels = _panels(figure, renderer, on, size)
        shares = [least_share(panel[where], *of) for panel, (where, *of) in zip(panels, found, strict=True)]
        yield DATA.check(
            "of what skin, highlights and the vectors' length change, the least share that is seen",
            min(shares),
            on,
        )


def checks(figure, renderer):
    """The light against Blinn's; what colours of vertices lose, and where; the program's vectors."""
    yield from _displayed_checks(figure, renderer)
    size, fine, black = 256, {"around": 144, "across": 72}, {"background": (0.0, 0.0, 0.0)}
    highlight = {"color": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0), **black}
    for on in Answer:
        panels = _panels(figure, renderer, on, size, **black, **fine)
        shown = panels[2].max(axis=-1) > 0.0
        yield DATA.check(
            "RMS of light with the normaliser - Blinn's in float, on a fine ring",
            root_mean_square((panels[2] - panels[3])[shown]),
            on,
        )
        for what, changes in (("the figure's", {}), ("a fine", fine)):
            panels = _panels(figure, renderer, on, size, **highlight, **changes)
            yield Check(
                f"highlights with vectors as colours over those with the normaliser, {what} ring",
                float(panels[1].mean() / panels[2].mean()),
                **({"at_least": 0.97} if changes else {"at_most": 0.85}),
                on=on,
                reason="a vector between two is shorter than they are, its eighth power far shorter; of near "
                "vertices hardly",
            )
        hidden = shown & (panels[3].max(axis=-1) == 0.0)
        yield DATA.check(
            "mean of the highlights where the light is behind the ring's surface",
            float(panels[2][hidden].mean()),
            on,
        )
    ring, light = _ring(24, 12), Light(figure.values["light"], point=True)
    view = _view(row_of_panels(1, size)[0])
    pairs = zip(
        vertex_program_vectors.light_and_half_vectors(ring, view, light),
        _by_host(ring, view, light),
        strict=True,
    )
    apart = max(float(np.abs(a - b).max()) for a, b in pairs)
    yield DATA.check(
        "a vertex program's l and h - the host's, largest difference", apart, Answer.IDEAL, at_most=2.0**-20
    )


# Two general combiners and the final one square three times, three of them four times.
_EXPONENT = "How often n.h is squared: its exponent in the highlight."
_BY_TWO = {"exponent": word.of(word.Choice({"2": 2, "4": 4, "8": 8}), 8, _EXPONENT)}
_BY_MORE = {"exponent": word.of(word.Choice({"2": 2, "4": 4, "8": 8, "16": 16}), 16, _EXPONENT)}
_HOST, _PROGRAM = scene_by(_by_host), scene_by(vertex_program_vectors.light_and_half_vectors)

FIGURE = Figure(
    **DATA.words,
    parameters={
        "cube_map_size": word.TEXELS(64, "The edge of the cube maps' faces.", low=4, high=256),
        "around": word.of(word.Whole(3, 256), 16, "Segments of the ring around its axis."),
        "across": word.of(word.Whole(3, 128), 8, "Segments of the ring across its tube."),
        "scales": word.EVEN(8, "Scales along an edge of the map, which goes 6 times around the ring."),
        "depth": word.NUMBER(0.5, "How high the scales' tips stand, of a scale's width.", low=0.0, high=2.0),
        "light": word.POSITION((-0.35, 0.75, 1.2), "Where the lamp is; the ring's radius is 1.05."),
        "color": word.DIFFUSE((1.0, 0.95, 0.86)),
        "ambient": word.AMBIENT((0.09, 0.10, 0.13)),
        "specular": word.NUMBER(0.75, "The highlight's strength, k_s.", low=0.0, high=1.0),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the scales"),
        "height_scale": own_maps.HEIGHT_SCALE(0.05),
    },
    methods=(
        Method("register combiners, vectors by the host", _HOST, ("GEFORCE_256",), parameters=_BY_TWO),
        Method(
            "register combiners, vectors by a vertex program",
            _PROGRAM,
            ("GEFORCE_3", "NV2A"),
            parameters=_BY_MORE,
        ),
    ),
    acceptance=checks,
    reference=reference,
)
