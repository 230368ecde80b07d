"""Z05, Z06 and Z07 side by side: one lighting in camera, in object and in tangent space."""

import numpy as np

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
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.encoding import dot_product_texels
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "Z05")

EYE = (0.3, 1.2, 3.5)


def scene(
    profile, size, *, relief, light, diffuse, ambient, specular, background, maps, height_field, height_scale
):
    """Z05: a panel for each space; ``maps``: the height of the normal maps, None: fit for the panel."""
    n = slices(size)
    surface = surfaces.sphere(n, n // 2)
    edge = texels(size) if maps is None else maps
    normals = bump_normals(edge, relief, height_field, height_scale)
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
    for panel, (lit, name) in zip(row_of_panels(3, size), passes, strict=True):
        view = perspective_view(panel, EYE, field_of_view=34.0, radius=1.1)
        out += (
            panel.clear(background),
            *lit(
                surface, name, view, Light(light), profile, color=diffuse, ambient=ambient, specular=specular
            ),
        )
    return tuple(out)


def checks(figure, renderer):
    """That the three spaces show one picture, as far as what is interpolated allows."""
    size, maps = 128, 256
    black = {"background": (0.0, 0.0, 0.0), "maps": maps}
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
    yield arithmetic_check(figure, renderer, 0.006, POWER_8)


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
    },
    methods=(Method("texture shaders and register combiners", scene, ("GEFORCE_3", "NV2A")),),
    acceptance=checks,
)
