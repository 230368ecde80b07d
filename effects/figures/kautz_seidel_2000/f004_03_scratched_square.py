"""F004-3: one square with scratches along both axes, under three lights."""

import math

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, IMAGING_MACHINES, Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, imaging_subset, material_textures

DATA = figure_data(__file__, "F004-3")
_IMAGING = "imaging subset"


def scratched_square(seed, count):
    """F004-3's material: 256 x 256 texels, alpha 0.5, scratches of alpha_x = 0.25 and alpha_y = 1."""
    return material_textures.scratched(
        256,
        count,
        alpha_x=0.25,
        alpha_y=1.0,
        alpha=0.5,
        k_s=0.22,
        k_s_scratch=(0.55, 0.95),
        slope=0.15,
        seed=seed,
    )


def _panels(size, elevation, extent):
    """(panel, view, light) of the three pictures: light from +x, from +y, from the top."""
    low = rotate(rotation("y", 90.0 - elevation), np.array([0.0, 0.0, 1.0]))
    lights = (
        Light((float(low[0]), 0.0, float(low[2]))),
        Light((0.0, float(low[0]), float(low[2]))),
        Light((0.0, 0.0, 1.0)),
    )
    angle = 2.0 * math.degrees(math.atan(0.2 / extent))
    for panel, light in zip(row_of_panels(3, size), lights, strict=True):
        yield panel, perspective_view(panel, (0.0, 0.0, 5.0), field_of_view=angle), light


def scene(profile, size, *, seed, count, elevation, extent, diffuse, ambient, specular, background):
    """F004-3: one square, three lights: from +x, from +y, from the top."""
    loading, names = material_textures.load(scratched_square(seed, count).material, "scratches", profile)
    surface, out = surfaces.plane(), list(loading)
    for panel, view, light in _panels(size, elevation, extent):
        out += (
            panel.clear(background),
            *diffuse_bump.diffuse_pass(
                surface, names.normal, view, light, profile, color=diffuse, ambient=ambient
            ),
            *anisotropic_blinn_phong.specular_pass(surface, names, view, light, profile, specular=specular),
        )
    return tuple(out)


def imaging_scene(profile, size, *, seed, count, elevation, extent, diffuse, ambient, specular, background):
    """The same with the imaging subset (K08): the square is one polygon, and each of the three has one
    halfway vector.
    """
    material, surface, out = scratched_square(seed, count).material, surfaces.plane(), []
    for panel, view, light in _panels(size, elevation, extent):
        out += (
            panel.clear(background),
            *imaging_subset.commands(
                surface,
                material,
                view,
                light,
                profile,
                color=diffuse,
                ambient=ambient,
                specular=specular,
                name="scratches",
                triangles_per_polygon=2,
            ),
        )
    return tuple(out)


def scratch_visibility(image, material, extent):
    """Contrast (on - off)/(on + off) of the scratches along x and along y in one panel.

    ``image``: float64 [size, size] intensities, bottom row first. A pixel belongs to the texel under its
    centre.
    """
    x, y = pixel_grid(image.shape[0], extent)
    edge = material.scratched.shape[0]
    inside = np.maximum(np.abs(x), np.abs(y)) < 1.0
    column = np.clip(np.floor((x + 1.0) * (0.5 * edge)).astype(np.int64), 0, edge - 1)
    row = np.clip(np.floor((y + 1.0) * (0.5 * edge)).astype(np.int64), 0, edge - 1)
    off = float(image[inside & ~material.scratched[row, column]].mean())
    contrasts = []
    for scratches in (material.along_s, material.along_t):
        on = float(image[inside & scratches[row, column]].mean())
        contrasts.append((on - off) / (on + off))
    return tuple(contrasts)


def _by_pixels(values, size, local):
    """The square's Seen, and of each panel its pixels by Eq. 1 in float64, then without a material's field
    each: [1 + fields, n, 3].

    ``local``: whether each pixel has its own halfway vector; without, all have the middle's.
    """
    seen = seen_places.square(size, values["extent"])
    fields = material_reference.fields(scratched_square(values["seed"], values["count"]).material)
    # The viewer is five half edges before the square's middle.
    aside = float(local) * np.stack([1.0 - 2.0 * seen.s, 1.0 - 2.0 * seen.t, 0.0 * seen.s], axis=-1)
    eye = aside + np.array((0.0, 0.0, 5.0))
    angle = math.radians(values["elevation"])
    low, high = math.cos(angle), math.sin(angle)
    found = [
        material_reference.pictures(fields, seen, {**values, "light": light}, eye=eye)
        for light in ((low, 0.0, high), (0.0, low, high), (0.0, 0.0, 1.0))
    ]
    # Light from the top does not tell normals that lean by a slope of 0.15 from straight ones: their cosines
    # are 0.99.
    found[2] = np.delete(found[2], 1 + list(fields).index("normals"), axis=0)
    return seen, found


def _displayed_checks(figure, renderer):
    """The displayed panels beside those without a material's field, and beside the other lights'."""
    seen, found = _by_pixels(figure.values, figure.size, renderer.method.name != _IMAGING)
    for on in (Answer.MACHINE, Answer.IDEAL):
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        shares = [
            material_reference.least_share(
                panel_of(window, k)[seen.where], *of, *(other[0] for other in found if other is not of)
            )
            for k, of in enumerate(found)
        ]
        yield DATA.check(
            "of what the material and the light change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """Which scratches each light shows, on the ideal and on the machine."""
    yield from _displayed_checks(figure, renderer)
    size = 512
    material = scratched_square(figure.values["seed"], figure.values["count"])
    reasons = {
        Answer.IDEAL: "the catalogue's acceptance",
        Answer.MACHINE: "the catalogue's acceptance; the contrast is a mean over thousands of pixels, in "
        "which rounding to bytes averages out",
    }
    for on in Answer:
        image = renderer.window(on, figure, size).mean(axis=-1)
        from_x, from_y, top = (
            scratch_visibility(image[:, k * size : (k + 1) * size], material, figure.values["extent"])
            for k in range(3)
        )
        for name, value, bound in (
            ("light from +x: scratches along y seen", from_x[1], {"at_least": 0.3}),
            ("light from +x: scratches along x not seen, |contrast|", abs(from_x[0]), {"at_most": 0.05}),
            ("light from +y: scratches along x seen", from_y[0], {"at_least": 0.3}),
            ("light from +y: scratches along y not seen, |contrast|", abs(from_y[1]), {"at_most": 0.05}),
            ("light from the top: scratches along x seen", top[0], {"at_least": 0.15}),
            ("light from the top: scratches along y seen", top[1], {"at_least": 0.15}),
        ):
            yield Check(name, value, **bound, on=on, reason=reasons[on])


FIGURE = Figure(
    **DATA.words,
    parameters={
        "seed": word.SEED(7, "Which scratches there are."),
        "count": word.COUNT(30, "Scratches along each axis."),
        "elevation": word.DEGREES(
            20.0, "How high the two low lights stand over the square.", low=0.0, high=90.0
        ),
        "extent": word.EXTENT(0.9),
        "diffuse": word.DIFFUSE((0.28, 0.32, 0.38)),
        "ambient": word.AMBIENT((0.05, 0.055, 0.07)),
        "specular": word.SPECULAR((1.0, 0.97, 0.90)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("register combiners", scene, COMBINER_MACHINES),
        Method(_IMAGING, imaging_scene, IMAGING_MACHINES),
    ),
    acceptance=checks,
)
