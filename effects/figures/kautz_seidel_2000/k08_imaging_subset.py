"""K08: Eq. 1 by the imaging subset with flat triangles, next to a halfway vector for every pixel."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, IMAGING_MACHINES_8, Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import cross, dot, in_frame, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import evaluate_then_interpolate, imaging_subset, material_textures
from fixedpipe.effects.reflectance.material_textures import Brushing
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import RasterPosition

DATA = figure_data(__file__, "K08")


def _sphere_at(size, radius):
    """What pixels see of the unit sphere, its axis upright: which do, their normals, and s, t.

    Angles are rounded to 2**-20 of a turn, so that they have the same bits everywhere.
    """
    x, y = pixel_grid(size, radius)
    square = x * x + y * y
    inside = square < 1.0
    normals = np.stack([x, y, np.sqrt(np.maximum(1.0 - square, 0.0))], axis=-1)
    s = np.arctan2(normals[..., 0], normals[..., 2]) / (2.0 * math.pi) + 0.5
    t = np.arcsin(np.clip(normals[..., 1], -1.0, 1.0)) / math.pi + 0.5
    s, t = (np.floor(angle * 2.0**20 + 0.5) * 2.0**-20 for angle in (s, t))
    return inside, normals, s, t


def _smooth(size, material, light, radius, diffuse, ambient, specular, background):
    """The picture that a halfway vector for every pixel gives, in float: [size, size, 3]."""
    inside, normals, s, t = _sphere_at(size, radius)
    tangents = normalize(cross(np.array([0.0, 1.0, 0.0]), normals))
    frame = tangents, cross(normals, tangents), normals
    toward = light.light_vectors(np.zeros(3))
    local_light = in_frame(toward, *frame)
    lit = evaluate_then_interpolate.diffuse(material, local_light, s, t)[..., None]
    half = in_frame(normalize(toward + np.array([0.0, 0.0, 1.0])), *frame)
    highlight = evaluate_then_interpolate.specular(material, half, s, t)[..., None]
    color = lit * np.array(diffuse) + np.array(ambient)
    color = color + np.minimum(1.0, 4.0 * lit) * (highlight * np.array(specular))
    return np.clip(np.where(inside[..., None], color, np.array(background)), 0.0, 1.0)


def scene(
    profile, size, *, slices, stacks, light, radius, diffuse, ambient, specular, background, **brushing
):
    """Left the float picture, in the middle K08, on the right K08 without the colour matrix's bias."""
    left, *others = row_of_panels(3, size)
    material = material_textures.brushed(128, 64, Brushing.ALONG_S, **brushing)
    surface, toward = surfaces.sphere(slices, stacks), Light(light)
    picture = _smooth(size, material, toward, radius, diffuse, ambient, specular, background)
    out = [
        left.clear(background),
        DrawPixels(
            label="show what a halfway vector for every pixel gives",
            image=PixelImage(factor_texels(picture, profile), "RGB"),
            position=RasterPosition((float(left.x), float(left.y), 0.0, 1.0), window=True),
        ),
    ]
    for panel, name, biased in zip(others, ("biased", "not biased"), (True, False), strict=True):
        view = orthographic_view(panel, half_height=1.0 / radius)
        prepared = imaging_subset.prepare(surface, material, view, profile, name=name)
        out += (
            panel.clear(background),
            *imaging_subset.specular_passes(prepared, material, toward, specular=specular, biased=biased),
            *imaging_subset.diffuse_pass(prepared, material, toward, color=diffuse, ambient=ambient),
        )
    return tuple(out)


def _largest_step(image, inside):
    """The largest difference of pixels side by side on the sphere."""
    pairs = inside[:, 1:] & inside[:, :-1]
    return float(np.abs(np.diff(image, axis=1))[pairs].max())


def checks(figure, renderer):
    """That facets are visible, that they have the smooth highlight's light, and what the bias prevents."""
    size, radius = 256, figure.values["radius"]
    inside, normals, _, _ = _sphere_at(size, radius * 0.97)
    inside &= np.abs(normals[..., 1]) < 0.8  # where a pixel is not as high as the triangles at the poles
    toward = normalize(np.array(figure.values["light"]))
    half = normalize(toward + np.array([0.0, 0.0, 1.0]))
    tangents = normalize(cross(np.array([0.0, 1.0, 0.0]), normals))
    # A triangle's width away from where the products change sign, and where the light's gate is open.
    away = 2.0 * math.pi / figure.values["slices"]
    lit = inside & (dot(normals, toward) > 0.4)
    negative = lit & (dot(half, tangents) < -away) & (dot(half, cross(normals, tangents)) < -away)
    changes = {**DARK, "specular": (1.0, 1.0, 1.0), "spread": 0.0, "depth": 0.0, "k_s": (1.0, 1.0)}
    images = {on: renderer.window(on, figure, size, **changes)[..., 0] for on in Answer}
    for on, image in images.items():
        smooth, flat, lost = (image[:, k * size : (k + 1) * size] for k in range(3))
        yield DATA.check(
            "largest step between pixels side by side, flat triangles over smooth",
            _largest_step(flat, inside) / _largest_step(smooth, inside),
            on,
        )
        yield DATA.check(
            "light of the highlight, flat triangles over smooth: deviation from one",
            abs(float(flat[inside].sum() / smooth[inside].sum()) - 1.0),
            on,
        )
        yield DATA.check(
            "least of the highlight without the bias where both products are negative",
            float(lost[negative].min()),
            on,
        )
        yield DATA.check(
            "mean of the smooth highlight at the same pixels", float(smooth[negative].mean()), on
        )
    yield DATA.check(
        "RMS of machine - ideal, the highlight alone",
        root_mean_square(images[Answer.MACHINE] - np.clip(images[Answer.IDEAL], 0.0, 1.0)),
        Answer.MACHINE,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "slices": word.SLICES(24),
        "stacks": word.STACKS(13),
        "spread": word.SPREAD(8.0),
        "depth": word.STROKE_DEPTH(0.2),
        "k_s": word.K_S((0.6, 1.0)),
        "alpha_x": word.ALPHA_X(0.5),
        "alpha_y": word.ALPHA_Y(0.9),
        "light": word.LIGHT((0.35, 0.45, 0.82)),
        "radius": word.RADIUS(0.92),
        "diffuse": word.DIFFUSE((0.30, 0.17, 0.10)),
        "ambient": word.AMBIENT((0.04, 0.02, 0.02)),
        "specular": word.SPECULAR((0.95, 0.78, 0.64)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("imaging subset", scene, IMAGING_MACHINES_8),),
    acceptance=checks,
)
