"""K16: combiners before the filter or after it, at the creases of a dome and on a smooth bump."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.rings import RING_HALF, ring_energy
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, future_board, material_textures

DATA = figure_data(__file__, "K16")


def smooth_slopes(s, t, height=0.34, radius=0.85):
    """Slopes of a bump per unit square of (s, t), without a crease: ``height (1 - r^2)^3`` high, flat beyond
    r = 1. ``radius`` and ``height`` in half the square's edge; the steepest is 1.717 height / radius.
    """
    u, v = s * 2.0 - 1.0, t * 2.0 - 1.0
    rest = np.maximum(0.0, 1.0 - (u * u + v * v) / (radius * radius))
    steepness = -6.0 * height / (radius * radius) * (rest * rest)
    return u * steepness, v * steepness


SURFACES = {"dome": height_fields.dome_slopes, "smooth bump": smooth_slopes}


def scene(profile, size, *, map_size, alpha, extent, diffuse, ambient, specular, background):
    """K16: a dome, then a smooth bump; each with vectors filtered first, and with results filtered."""
    toward = normalize(2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0]))
    light, surface = Light(tuple(toward)), surfaces.plane(1, 1, extent, extent)
    panels, out = iter(row_of_panels(4, size)), []
    for name, slopes in SURFACES.items():
        centers = height_fields.texel_centers(map_size, map_size)
        material = material_textures.from_slopes(*slopes(*centers), alpha, alpha)
        loading, names = material_textures.load(material, name, profile)
        out += loading
        for before in (False, True):
            panel = next(panels)
            view = orthographic_view(panel)
            passes = (
                panel.clear(background),
                *diffuse_bump.diffuse_pass(
                    surface, names.normal, view, light, profile, color=diffuse, ambient=ambient
                ),
                *anisotropic_blinn_phong.specular_pass(
                    surface, names, view, light, profile, specular=specular, gated=False
                ),
            )
            out += future_board.evaluated_first(passes) if before else passes
    return tuple(out)


def highlight_error(image, alpha):
    """RMS of a smooth bump's highlight against Eq. 1 with the frame of every pixel's own point.

    ``image``: float64 [size, size], bottom row first.
    """
    size = image.shape[0]
    frame = height_fields.frames(*smooth_slopes(*height_fields.texel_centers(size, size)))
    return root_mean_square(image - brdfs.anisotropic_blinn_phong(RING_HALF, *frame[1:], alpha, alpha))


def _by_pixels(seen, values):
    """Each panel's pixels by Eq. 1 in float64, then without a material's field each, then in the other order:
    [1 + others, n, 3].
    """
    # The lamp whose halfway vector is RING_HALF.
    values = {**values, "light": 2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0])}
    centers = height_fields.texel_centers(*2 * [values["map_size"]])
    for slopes in SURFACES.values():
        material = material_textures.from_slopes(*slopes(*centers), *2 * [values["alpha"]])
        both = [
            material_reference.pictures(
                material_reference.fields(material), seen, values, gated=False, squared_first=before
            )
            for before in (False, True)
        ]
        for one, other in (both, both[::-1]):
            yield np.concatenate([one, other[:1]])


def _displayed_checks(figure, renderer):
    """The displayed panels beside those without a field, and beside the other order's."""
    seen = seen_places.square(figure.size, figure.values["extent"])
    found = list(_by_pixels(seen, figure.values))
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        shares = [
            material_reference.least_share(panel_of(window, k)[seen.where], *of) for k, of in enumerate(found)
        ]
        yield DATA.check(
            "of what the material and the order of filter and combiners change, the least share that is seen",
            min(shares),
            on,
        )


def checks(figure, renderer):
    """Evaluating first is right at the crease, and wrong on the smooth bump."""
    yield from _displayed_checks(figure, renderer)
    size = 256
    changes = {**DARK, "specular": (1.0, 1.0, 1.0), "extent": 1.0}
    map_size, alpha = (figure.values[name] for name in ("map_size", "alpha"))
    for on in Answer:
        image = renderer.window(on, figure, size, **changes)[..., 0]
        panels = [image[:, k * size : (k + 1) * size] for k in range(4)]
        filtered_first, evaluated_first = (ring_energy(p, map_size, alpha, alpha)[0] for p in panels[:2])
        smooth_first, smooth_after = (highlight_error(p, alpha) for p in panels[2:])
        yield DATA.check("ring energy at the dome's rim, vectors filtered", filtered_first, on)
        yield DATA.check(
            "ring energy at the dome's rim, results filtered", evaluated_first, on, at_most=1.1 * 7e-4
        )
        yield DATA.check(
            "RMS on the smooth bump, results filtered / vectors filtered", smooth_after / smooth_first, on
        )
        yield DATA.check("RMS on the smooth bump, results filtered", smooth_after, on)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "map_size": word.TEXELS(32),
        "alpha": word.ALPHA_X(
            0.25, "The highlight's width along tangents and binormals: the smaller, the narrower."
        ),
        "extent": word.EXTENT(0.94),
        "diffuse": word.DIFFUSE((0.36, 0.40, 0.50)),
        "ambient": word.AMBIENT((0.04, 0.045, 0.06)),
        "specular": word.SPECULAR((0.9, 0.9, 0.85)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("both orders", scene, ("FUTURE",)),),
    acceptance=checks,
)
