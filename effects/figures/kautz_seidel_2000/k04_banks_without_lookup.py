"""K04: the Banks model with R*(s) = 1 - s by register combiners, next to the exact model."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.brushed_sphere import BRUSHED_SPHERE
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import in_frame, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import ADD, LATER_PASS, show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import (
    banks_without_lookup,
    brdfs,
    evaluate_then_interpolate,
    material_textures,
)
from fixedpipe.effects.reflectance.material_textures import Brushing

DATA = figure_data(__file__, "K04")


def _material(columns, rows, spread, depth, k_s):
    return material_textures.brushed(
        columns, rows, Brushing.ALONG_S, alpha_x=1.0, alpha_y=1.0, spread=spread, depth=depth, k_s=k_s
    )


def sphere_at_pixels(size, radius, tilt):
    """The sphere that fills ``radius`` of a panel at the pixels' centres, bottom row first.

    Returns (covered, s, t, frame): bool [size, size], then of the covered pixels the texture coordinates,
    float64 [n], and (tangents, binormals, normals) in world coordinates, float64 [n, 3] each.
    """
    x, y = pixel_grid(size, radius)
    covered = x * x + y * y < 1.0
    x, y = x[covered], y[covered]
    points = np.stack([x, y, np.sqrt(1.0 - (x * x + y * y))], axis=-1)
    upright = rotate(rotation("x", -tilt), points)
    # Arcs differ in their last bit between processors: rounded, their pictures do not.
    step = 2.0**20
    s, t = (
        np.floor(arc * step + 0.5) / step
        for arc in (
            np.arctan2(upright[:, 0], upright[:, 2]) / (2.0 * math.pi) + 0.5,
            np.arcsin(np.clip(upright[:, 1], -1.0, 1.0)) / math.pi + 0.5,
        )
    )
    normals, tangents, binormals = (rotate(rotation("x", tilt), v) for v in surfaces.sphere_frames(s, t))
    return covered, s, t, (tangents, binormals, normals)


# What the software renderer evaluates.
MODELS = {"exact": brdfs.banks, "R*": brdfs.banks_approximate}


def software(size, material, light, radius, tilt, model, *, diffuse, ambient, specular, background):
    """A software renderer's picture: one of ``MODELS`` evaluated at the texels, then interpolated (K16).

    float64 [size, size, 3], 1.0 = full.
    """
    covered, s, t, frame = sphere_at_pixels(size, radius, tilt)
    toward_light = in_frame(unit_vector(light, "The light's direction"), *frame)
    toward_viewer = in_frame(np.array([0.0, 0.0, 1.0]), *frame)
    lit = evaluate_then_interpolate.diffuse(material, toward_light, s, t)[..., None] * np.array(diffuse)
    highlight = banks_without_lookup.evaluated_first(
        material, toward_light, toward_viewer, s, t, MODELS[model]
    )
    picture = np.broadcast_to(np.array(background, np.float64), (size, size, 3)).copy()
    picture[covered] = (highlight[..., None] * np.array(specular) + lit) + np.array(ambient)
    return np.clip(picture, 0.0, 1.0)


def scene(
    profile, size, *, single_pass, model, slices, stacks, map_columns, map_rows, spread, depth, k_s, tilt,
    light, radius, diffuse, ambient, specular, background,
):  # fmt: skip
    """K04: left a software renderer's image of ``model``, right R* on the machine, the diffuse pass added."""
    left, right = row_of_panels(2, size)
    material = _material(map_columns, map_rows, spread, depth, k_s)
    colors = {"diffuse": diffuse, "ambient": ambient, "specular": specular, "background": background}
    picture = software(size, material, light, radius, tilt, model, **colors)
    surface = surfaces.sphere(slices, stacks).rotated(rotation("x", tilt))
    view, toward = orthographic_view(right, half_height=1.0 / radius), Light(light)
    loading, names = banks_without_lookup.load(material, "brushing", profile)
    highlight = banks_without_lookup.specular_pass if single_pass else banks_without_lookup.specular_passes
    return (
        left.clear(background),
        right.clear(background),
        *show(factor_texels(picture, profile), left, "software renderer's image", surfaces.plane()),
        *loading,
        *highlight(surface, names, view, toward, profile, specular=specular),
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, toward, profile, color=diffuse, ambient=ambient,
            depth_test=LATER_PASS, blending=ADD,
        ),
    )  # fmt: skip


def checks(figure, renderer):
    """R* on the machine against the model in float, and R* against the exact model."""
    size = 160
    white = {**DARK, "specular": (1.0, 1.0, 1.0), "slices": 100, "stacks": 50}
    x, y = pixel_grid(size, figure.values["radius"])
    inside = x * x + y * y < 0.9
    in_float = {**white, "model": "R*"}
    for on in Answer:
        image = renderer.window(on, figure, size, **in_float)[..., 0]
        error = root_mean_square((image[:, size:] - image[:, :size])[inside])
        yield DATA.check("RMS of the passes - R* in float", error, on)

    # Light at right angles to the viewer: the cone l.t = -v.t is the meridian at 45 degrees, (v.t)^2 = 1/2.
    smooth = {**white, "spread": 0.0, "depth": 0.0, "k_s": (1.0, 1.0), "tilt": 0.0, "light": (1.0, 0.0, 0.0)}
    on_the_cone = (np.abs(y) < 0.5) & (np.abs(x - np.sqrt(0.5 * np.maximum(0.0, 1.0 - y * y))) < 0.01)
    for on, darkest, peak in ((Answer.IDEAL, 0.002, 0.002), (Answer.MACHINE, 0.02, 0.01)):
        image = renderer.window(on, figure, size, **smooth)[..., 0]
        exact, approximate = image[:, :size], image[:, size:]
        darker = (exact - approximate)[inside]
        ratio = float((approximate[on_the_cone] / exact[on_the_cone]).mean())
        yield DATA.check("R* - exact, largest", -float(darker.min()), on, at_most=darkest)
        yield DATA.check("exact - R*, largest", float(darker.max()), on, at_most=0.25 + darkest)
        yield DATA.check(
            "R* / exact on the cone l.t = -v.t where (v.t)^2 = 1/2, off 0.75",
            abs(ratio - 0.75),
            on,
            at_most=peak,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "single_pass": word.FLAG(
            False, "Whether the highlight is drawn in one pass, for which GeForce 256 has too few units."
        ),
        "model": word.of(
            word.Choice({name: name for name in MODELS}),
            "exact",
            "What the left picture evaluates: Banks's model, or the R* that passes compute.",
        ),
        **BRUSHED_SPHERE,
        "tilt": word.DEGREES(8.0, "How far the sphere's upper pole leans towards the viewer."),
        "light": word.LIGHT((0.8, 0.4, 0.6)),
        "radius": word.RADIUS(0.92),
        "diffuse": word.DIFFUSE((0.20, 0.10, 0.07)),
        "ambient": word.AMBIENT((0.05, 0.03, 0.025)),
        "specular": word.SPECULAR((0.95, 0.80, 0.66)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("register combiners, several passes", scene, ("GEFORCE_256",)),
        Method("register combiners, one pass", scene, ("GEFORCE_3", "NV2A", "FUTURE"), {"single_pass": True}),
    ),
    acceptance=checks,
)
