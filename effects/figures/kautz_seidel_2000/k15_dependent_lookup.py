"""K15: pixel textures as the only dependent lookup, and the host where there are none."""

from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import unit_vector
from fixedpipe.effects.geometry.vertex_vectors import light_vectors
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes import pixel_texture_copies
from fixedpipe.effects.passes.draws import ADD, EDGE, draw, unit
from fixedpipe.effects.passes.encoding import vector_colors
from fixedpipe.effects.reflectance import blinn_phong_by_host, brdfs, material_textures, pixel_textures
from fixedpipe.effects.reflectance.pixel_textures import UpTo
from fixedpipe.pipeline.commands import Clear, CopyPixels, HostStep
from fixedpipe.pipeline.profiles import OCTANE

DATA = figure_data(__file__, "K15")

EYE = np.array([0.0, 0.0, 1.0])


@lru_cache(maxsize=2)
def _material(map_size, bumps, depth, alpha_x, alpha_y, exponents, height_field=None, height_scale=0.0):
    """Pebbles, or a height field, whose exponent changes from strip to strip, from left to right."""
    if height_field is None:
        slopes = height_fields.pebble_slopes(map_size, bumps, depth)
    else:
        slopes = height_field.slopes(map_size, height_scale, repeated=False)
    material = material_textures.from_slopes(*slopes, alpha_x, alpha_y)
    strip = np.arange(map_size) * len(exponents) // map_size
    exponent = np.broadcast_to(np.array(exponents)[strip], (map_size, map_size))
    return replace(material, exponent=exponent)


def pixel_textures_scene(profile, size, *, light, extent, diffuse, specular, background, **pebbles):
    """K15 by the color matrix and a pixel texture."""
    material = _material(**pebbles)
    surface, toward, out = surfaces.plane(1, 1, extent, extent), Light(light), []
    for panel, up_to in zip(row_of_panels(3, size), UpTo, strict=True):
        scene = surface, material, orthographic_view(panel), toward, profile
        color = {"specular": specular} if up_to is UpTo.GLOSS else {}
        out += (
            panel.clear(background),
            *pixel_textures.blinn_phong(*scene, up_to=up_to, sampler=EDGE, **color),
            *(pixel_textures.diffuse(*scene, color=diffuse, sampler=EDGE) if up_to is UpTo.GLOSS else ()),
        )
    return tuple(out)


def host_scene(profile, size, *, light, extent, diffuse, specular, background, **pebbles):
    """K15 by register combiners and the host."""
    material = _material(**pebbles)
    surface, toward = surfaces.plane(1, 1, extent, extent), Light(light)
    loading, names = material_textures.load(material, "pebbles", profile)
    out = list(loading)
    for panel, up_to in zip(row_of_panels(3, size), UpTo, strict=True):
        view = orthographic_view(panel)
        color = {"specular": specular} if up_to is UpTo.GLOSS else {}
        effect = blinn_phong_by_host.blinn_phong(
            surface, names, view, toward, profile, up_to=up_to, sampler=EDGE, **color
        )
        vectors = vector_colors(light_vectors(surface, toward), profile)
        added = draw(
            "plus (n.l)+",
            surface.mesh(colors=vectors),
            view,
            diffuse_bump.diffuse_combiners(diffuse),
            (unit(names.normal, EDGE),),
            blending=ADD,
        )
        out += (panel.clear(background), *effect, *((added,) if up_to is UpTo.GLOSS else ()))
    return tuple(out)


def _in_float(p, seen):
    """Each panel's pixels in float64 by a figure's values, then with one N, then with one e. The last panel's
    then without diffuse light. Float64 [n, 3] each. N and e are filtered, and F is taken of them then.
    """
    m = _material(*(p[name] for name in ("map_size", "bumps", "depth", "alpha_x", "alpha_y", "exponents")))
    toward = seen_places.unit(np.array(p["light"]))
    half = seen_places.unit(toward + EYE)
    lost = (m.tangents @ half / p["alpha_x"]) ** 2 + (m.binormals @ half / p["alpha_y"]) ** 2
    e = seen_places.looked_up(np.maximum(1.0 - lost, 0.0), seen)
    s = seen_places.looked_up(np.log2(m.exponent) / 7.0, seen)
    lit = seen_places.looked_up(np.maximum(m.normals @ toward, 0.0), seen)[:, None] * np.array(p["diffuse"])

    def panels(s, e, lit):
        power = (np.sqrt(e) ** 2.0 ** (7.0 * s))[:, None]
        both = np.clip(power * np.array(p["specular"]) + lit, 0.0, 1.0)
        return np.stack([s, e, e], axis=-1), np.repeat(power, 3, axis=1), both

    whole, one_n, one_e = (
        panels(s, e, lit),
        panels(0.0 * s + s.mean(), e, lit),
        panels(s, 0.0 * e + e.mean(), lit),
    )
    copied, looked_up, both = zip(whole, one_n, one_e, strict=True)
    return copied, looked_up, (*both, panels(s, e, 0.0 * lit)[2])


def _displayed_checks(figure, renderer):
    """The displayed panels beside those with one N, with one e, and without diffuse light."""
    seen = seen_places.square(figure.size, figure.values["extent"])
    found = _in_float(figure.values, seen)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        shares = [least_share(panel_of(window, k)[seen.where], *of) for k, of in enumerate(found)]
        yield DATA.check(
            "of what N, e and the diffuse light change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """The lookup against the float model, the host's picture against the Octane's, and the copied
    coordinates.
    """
    yield from _displayed_checks(figure, renderer)
    p = figure.values
    size, by_host = p["map_size"], renderer.method.machines[0] != "OCTANE"
    black, white = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
    changes = {"diffuse": black, "background": black, "specular": white, "extent": 1.0}
    m = _material(*(p[name] for name in ("map_size", "bumps", "depth", "alpha_x", "alpha_y", "exponents")))
    half = brdfs.half_vector(unit_vector(p["light"], "The light"), EYE)
    lobe = half, m.tangents, m.binormals, m.alpha_x, m.alpha_y
    expected = brdfs.anisotropic_blinn_phong(*lobe, m.k_s, m.exponent)
    by_bytes = "; h, t and b are bytes, which e has in it" if by_host else ""
    reasons = {
        Answer.IDEAL: "F is sampled at 64 x 256 places and joined linearly between them",
        Answer.MACHINE: "e has 256 steps, and N multiplies its error by up to N/2 = 16" + by_bytes,
    }
    # Measured at the first correct picture, with a third of slack.
    bounds = {Answer.IDEAL: 0.0012, Answer.MACHINE: 0.0165 if by_host else 0.0052}
    e_bounds = {Answer.IDEAL: 1e-4, Answer.MACHINE: 0.0147 if by_host else 0.0019}
    for on in Answer:
        whole = renderer.window(on, figure, size, **changes)
        copied, picture, shaded = (whole[:, k * size : (k + 1) * size] for k in range(3))
        picture = picture[..., 0]
        error = root_mean_square(np.clip(copied[..., 1], 0.0, 1.0) - brdfs.lobe(*lobe))
        reason = "a table of squares" if on is Answer.IDEAL else reasons[on].partition(",")[0] + by_bytes
        yield Check("RMS of what is copied - e in float", error, at_most=e_bounds[on], on=on, reason=reason)
        error = root_mean_square(picture - expected)
        yield Check(
            "RMS of the lookup - F(N, e) in float", error, at_most=bounds[on], on=on, reason=reasons[on]
        )
        error = float(np.abs(shaded[..., 0] - picture).max())
        reason = "k_s is one and white, and no diffuse light is added"
        yield Check(
            "largest difference of the whole from the lookup", error, at_most=0.0, on=on, reason=reason
        )
        strips = np.arange(size) * len(p["exponents"]) // size
        bright = [(picture[:, strips == k] > 0.5).mean() for k in range(len(p["exponents"]))]
        falls = max(b / a for a, b in pairwise(bright))
        reason = "twice the exponent takes about half the highlight's area; the pebbles differ"
        yield Check(
            "largest ratio of areas above 1/2, strip to strip", falls, at_most=0.8, on=on, reason=reason
        )
    commands = figure.commands(renderer.profile, size, renderer.method)
    counted = HostStep if by_host else CopyPixels
    copies = sum(isinstance(c, counted) for c in commands[_last_clear(commands) :])
    yield Check(
        "lookups of the panel for one picture, " + ("by the host" if by_host else "by CopyPixels"),
        copies,
        at_most=1,
        on=Answer.MACHINE,
        reason="two parameters and one function: one copy of the panel, or one from the board and one to it",
    )
    width, height = figure.dimensions(size)
    if not by_host:
        drawn = figure.commands(renderer.profile, size, renderer.method)
        pictures = [
            renderer.execute(c, renderer.profile, width, height).framebuffer.color.astype(int)
            for c in (drawn, pixel_texture_copies.through_host(drawn))
        ]
        most = int(np.abs(pictures[1] - pictures[0]).max())
        reason = (
            "an extension's copy is its DrawPixels of the same pixels; the paper's route costs time alone"
        )
        name = "largest difference where each copy goes through host memory, codes"
        yield Check(name, most, at_most=0, on=Answer.MACHINE, reason=reason)
    else:
        on_octane = figure.commands(OCTANE, size, figure.method("OCTANE"), **changes)
        other = renderer.execute(on_octane, OCTANE, width, height).framebuffer.color[::-1, :, :3] / 255.0
        error = root_mean_square(renderer.machine_window(figure, size, **changes)[:, size:] - other[:, size:])
        reason = "either machine's bound of the distance from the model, added"
        bound = bounds[Answer.MACHINE] + 0.0052
        yield Check(
            "RMS of this picture - the Octane's", error, at_most=bound, on=Answer.MACHINE, reason=reason
        )


def _last_clear(commands):
    """Where the last panel's picture begins."""
    return max(k for k, c in enumerate(commands) if isinstance(c, Clear) and c.color is not None)


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "map_size": word.TEXELS(256),
        "bumps": word.EVEN(10, "Pebbles along an edge of the square."),
        "depth": word.SLOPE(0.5, "The pebbles' height over half balls."),
        "alpha_x": word.ALPHA_X(0.5),
        "alpha_y": word.ALPHA_Y(1.0),
        "exponents": word.of(
            word.Several(word.EXPONENT_KIND, 1, 16),
            (2.0, 4.0, 8.0, 16.0, 32.0),
            "The exponent N of each strip of the square, from left to right.",
        ),
        "light": word.LIGHT((0.45, 0.35, 0.82)),
        "extent": word.EXTENT(0.94),
        "diffuse": word.DIFFUSE((0.26, 0.30, 0.36)),
        "specular": word.SPECULAR((0.68, 0.66, 0.60)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.03),
    },
    methods=(
        Method("pixel textures", pixel_textures_scene, ("OCTANE",)),
        Method("register combiners, lookups by the host", host_scene, ("GEFORCE_256",)),
    ),
    acceptance=checks,
)
