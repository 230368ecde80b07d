"""Z05, Z06 and Z07 side by side: one lighting in camera, in object and in tangent space."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import POWER_8, arithmetic_check, root_mean_square
from fixedpipe.effects.bump_mapping import lighting_spaces, normalization_cube_map
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import load_normals, slices, texels
from fixedpipe.effects.figures.zwicker_2016.shared.bumpy_sphere import (
    FOR_DOT_PRODUCTS,
    FOR_OBJECT,
    FOR_TANGENT,
    bump_normals,
    object_normals,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    panel_of,
    perspective_view,
    row_of_panels,
)
from fixedpipe.effects.passes import differences as shown_differences
from fixedpipe.effects.passes.encoding import dot_product_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "Z05")

EYE = (0.3, 1.2, 3.5)
SPACES = ("camera", "object", "tangent")
# Assumed: a crease is where a filtered normal is shorter than 0.96, and what is lit has a mean above 0.3; a
# highlight has its three colours there, which diffuse light alone does not reach.
SHORT, LIT = 0.96, 0.3
# Source: the slides do not say.  Assumed: 7.5 degrees each, so that chords are seen where differences are.
MOST_SLICES = 48


def _sphere(size):
    n = min(slices(size), MOST_SLICES)
    return surfaces.sphere(n, n // 2)


def _view(panel):
    return perspective_view(panel, EYE, field_of_view=34.0, radius=1.1)


def _map_edge(size, maps):
    return texels(size) if maps is None else maps


def scene(
    profile,
    size,
    *,
    relief,
    light,
    diffuse,
    ambient,
    specular,
    background,
    maps,
    height_field,
    height_scale,
    differences,
):
    """Z05: a panel for each space; ``maps``: the height of the normal maps, None: fit for the panel.

    ``differences``: whether the second and the third show how they differ from the first, not themselves.
    """
    surface = _sphere(size)
    normals = bump_normals(_map_edge(size, maps), relief, height_field, height_scale)
    dot_products = texture_2d(dot_product_texels(normals, 1.0, profile))
    out = [
        normalization_cube_map.load(64, profile),
        TexImage(label=f"load {FOR_DOT_PRODUCTS}", texture=FOR_DOT_PRODUCTS, image=dot_products),
        load_normals(object_normals(normals), FOR_OBJECT, profile),
        load_normals(normals, FOR_TANGENT, profile),
    ]
    passes = (
        (lighting_spaces.camera_space_pass, FOR_DOT_PRODUCTS),
        (lighting_spaces.object_space_passes, FOR_OBJECT),
        (lighting_spaces.tangent_space_passes, FOR_TANGENT),
    )
    panels = row_of_panels(3, size)
    for panel, (lit, name) in zip(panels, passes, strict=True):
        view = _view(panel)
        out += (
            panel.clear(background),
            *lit(
                surface, name, view, Light(light), profile, color=diffuse, ambient=ambient, specular=specular
            ),
        )
    if differences:
        for panel, space in zip(panels, SPACES, strict=True):
            out += shown_differences.keep(panel, f"{space} space")
        for panel, space in zip(panels[1:], SPACES[1:], strict=True):
            out.append(
                shown_differences.show_difference(
                    f"{SPACES[0]} space", f"{space} space", panel, surfaces.plane()
                )
            )
    return tuple(out)


def _by_rays(size, p):
    """The lit sphere by rays, in float64: which pixels show it, bool [size, size], bottom row first; their
    colours [n, 3]; and how long the filtered normals of the map are there [n].
    """
    seen = seen_places.surface(_sphere(size), _view(Panel(0, 0, size, size)))
    filtered = seen_places.looked_up(bump_normals(_map_edge(size, p["maps"]), p["relief"]), seen)
    length = np.sqrt((filtered * filtered).sum(axis=-1))
    normals = seen_places.unit((filtered[:, None] @ seen.frames)[:, 0])
    # The sphere's radius is one: its normals are its points.
    toward, to_eye = seen_places.unit(np.array(p["light"])), seen_places.unit(EYE - seen.frames[:, 2])
    cosine = normals @ toward
    power = np.maximum((normals * seen_places.unit(toward + to_eye)).sum(axis=-1), 0.0) ** 8
    lit = np.maximum(cosine, 0.0)[:, None] * np.array(p["diffuse"]) + np.array(p["ambient"])
    return seen.where, lit + (p["specular"] * np.clip(4.0 * cosine, 0.0, 1.0) * power)[:, None], length


def _displayed_checks(figure, renderer):
    """What the must-see says of the figure's own picture."""
    size = figure.size
    where, true, length = _by_rays(size, figure.values)
    for on, share in seen_places.shares_alike(figure, renderer, {0: (where, true)}):
        yield DATA.check("first panel: pixels that show what a ray finds there within 8/255", share, on)
    creases, lit = length < SHORT, true.mean(axis=-1) > LIT
    bright = (true.min(axis=-1) > LIT) & ~creases
    for on in Answer:
        shown, spaces = (
            [panel_of(np.clip(renderer.window(on, figure, size, **change), 0.0, 1.0), k) for k in range(3)]
            for change in ({}, {"differences": False})
        )
        expected = (np.minimum(shown_differences.TIMES * np.abs(spaces[0] - spaces[k]), 1.0) for k in (1, 2))
        yield DATA.check(
            "second and third panel - 16 times the difference of what they show otherwise, largest",
            max(float(np.abs(shown[k] - e).max()) for k, e in zip((1, 2), expected, strict=True)),
            on,
        )
        for k, space in ((1, "object"), (2, "tangent")):
            level = shown[k][where].mean(axis=-1)
            lines, elsewhere = (float(level[at].mean()) for at in (creases & lit, ~creases))
            yield DATA.check("camera - {other} space, mean in lit creases", lines, on, other=space)
            yield DATA.check(
                "camera - {other} space, mean in lit creases over the mean elsewhere",
                lines / elsewhere,
                on,
                other=space,
            )
        middle, right = (float(shown[k][where].mean(axis=-1)[bright].mean()) for k in (1, 2))
        yield DATA.check("mean in highlights, third panel over second", right / middle, on)


def checks(figure, renderer):
    """That the three spaces show one picture, up to errors of interpolation."""
    size, maps = 128, 256
    black = {"background": (0.0, 0.0, 0.0), "maps": maps, "differences": False}
    images = {
        on: [panel_of(np.clip(renderer.window(on, figure, size, **black), 0.0, 1.0), k) for k in range(3)]
        for on in Answer
    }
    covered = images[Answer.IDEAL][0].sum(axis=-1) > 0.0
    # By where and what: of nine pixels in ten, and of all.
    bounds = {
        (Answer.IDEAL, "object"): (0.0025, 0.008),
        (Answer.IDEAL, "tangent"): (0.011, 0.0105),
        (Answer.MACHINE, "object"): (0.016, 0.013),
        (Answer.MACHINE, "tangent"): (0.016, 0.0147),
    }
    for (on, other), (most, every) in bounds.items():
        apart = np.abs(images[on][0] - images[on][("camera", "object", "tangent").index(other)])[covered]
        arithmetic = "" if on is Answer.IDEAL else "; 8-bit vectors and normals, to the eighth power"
        yield DATA.check(
            "camera space - {other} space, nine pixels in ten are below",
            float(np.percentile(apart, 90.0)),
            on,
            at_most=most,
            other=other,
            arithmetic=arithmetic,
        )
        yield DATA.check(
            "camera space - {other} space, RMS",
            root_mean_square(apart),
            on,
            at_most=every,
            other=other,
            arithmetic=arithmetic,
        )
    smooth = panel_of(renderer.ideal_window(figure, size, relief=0.0, **black), 0)
    yield DATA.check(
        "the bumps' own part of the picture, RMS",
        root_mean_square(np.clip(smooth, 0.0, 1.0)[covered] - images[Answer.IDEAL][0][covered]),
        Answer.IDEAL,
    )
    yield arithmetic_check(figure, renderer, 0.006, POWER_8, differences=False)
    yield from _displayed_checks(figure, renderer)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(0.45),
        "light": word.LIGHT((-0.55, 0.6, 0.58)),
        "diffuse": word.DIFFUSE((0.56, 0.34, 0.2)),
        "ambient": word.AMBIENT((0.05, 0.04, 0.04)),
        "specular": word.SHARE(0.4, "The strength of the highlights, which are white.", word.FULL),
        "background": word.BACKDROP(BACKGROUND),
        "maps": word.FITTED_TEXELS(None, "The height of the normal maps, which are twice as wide."),
        "height_field": own_maps.height_field("the bumps"),
        "height_scale": own_maps.HEIGHT_SCALE(0.06),
        "differences": word.FLAG(
            True,
            "Whether the second and the third panel show how they differ from the first, 16 times as large.",
        ),
    },
    methods=(Method("texture shaders and register combiners", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
