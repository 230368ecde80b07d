"""F004-2: domes in grooves; interpolating tangents before they are used makes rings at the creases."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.acceptance.rings import RING_HALF, ring_energy
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, IMAGING_MACHINES, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    evaluate_then_interpolate,
    future_board,
    imaging_subset,
    material_textures,
)
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import RasterPosition

EVALUATED_FIRST = "evaluation before filtering"
SQUARED_FIRST = "imaging subset"


def _dome_slopes(map_size, domes, rim_radius, rim_slopes, groove):
    """Slopes of domes x domes domes in one map; those of their rims are spread over a range."""
    s, t = (c * domes for c in height_fields.texel_centers(map_size, map_size))
    # Multiples of the golden ratio's fraction: domes that are near each other differ.
    share = ((np.floor(s) + domes * np.floor(t)) * 0.618034) % 1.0
    slope = rim_slopes[0] + (rim_slopes[1] - rim_slopes[0]) * share
    return height_fields.dome_slopes(s, t, rim_radius, slope, groove * (2.0 * domes / map_size))


def _bumps_material(map_size, alpha_x, alpha_y, k_s, height_field, height_scale, domes):
    if height_field is None:
        slopes = _dome_slopes(map_size, **domes)
    else:
        slopes = height_field.slopes(map_size, height_scale, repeated=False)
    return material_textures.from_slopes(*slopes, alpha_x, alpha_y, k_s)


def _reference(size, material, toward_light, extent, diffuse, ambient, specular, background):
    """K16's picture, evaluated at the texels and interpolated afterwards: float64 [size, size, 3]."""
    x, y = pixel_grid(size, extent)
    s, t = (x + 1.0) * 0.5, (y + 1.0) * 0.5
    half = normalize(toward_light + np.array([0.0, 0.0, 1.0]))
    lit = evaluate_then_interpolate.diffuse(material, toward_light, s, t)[..., None] * np.array(diffuse)
    highlight = evaluate_then_interpolate.specular(material, half, s, t)[..., None] * np.array(specular)
    covered = (np.maximum(np.abs(x), np.abs(y)) < 1.0)[..., None]
    return np.clip(np.where(covered, (lit + np.array(ambient)) + highlight, np.array(background)), 0.0, 1.0)


def _lit_domes(
    size, *, map_size, alpha_x, alpha_y, light, extent, diffuse, ambient, specular, background,
    height_field, height_scale, material, **domes,
):  # fmt: skip
    """The material, the surface, the light and the reference's picture."""
    k_s = getattr(material, "k_s", 1.0)
    material = own_maps.material_or(
        lambda: _bumps_material(map_size, alpha_x, alpha_y, k_s, height_field, height_scale, domes),
        material,
        height_field,
    )
    toward_light = unit_vector(light, "The light")
    surface = surfaces.plane(1, 1, extent, extent)
    picture = _reference(size, material, toward_light, extent, diffuse, ambient, specular, background)
    return material, surface, Light(light), picture


def scene(profile, size, **parameters):
    """F004-2: left the float reference (K16) shown as a picture, right the register combiners (K10, K07)."""
    left, right = row_of_panels(2, size)
    material, surface, light, picture = _lit_domes(size, **parameters)
    view = orthographic_view(right)
    loading, names = material_textures.load(material, "domes", profile)
    return (
        left.clear(parameters["background"]),
        right.clear(parameters["background"]),
        *show(factor_texels(picture, profile), left, "software renderer's image", surfaces.plane()),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface,
            names.normal,
            view,
            light,
            profile,
            color=parameters["diffuse"],
            ambient=parameters["ambient"],
        ),
        *anisotropic_blinn_phong.specular_pass(
            surface, names, view, light, profile, specular=parameters["specular"], gated=False
        ),
    )


def imaging_scene(profile, size, **parameters):
    """The same with the imaging subset on the right (K08): one flat polygon, one load of each material
    image.
    """
    left, right = row_of_panels(2, size)
    material, surface, light, picture = _lit_domes(size, **parameters)
    return (
        left.clear(parameters["background"]),
        right.clear(parameters["background"]),
        DrawPixels(
            label="show software renderer's image",
            image=PixelImage(factor_texels(picture, profile), "RGB"),
            position=RasterPosition((float(left.x), float(left.y), 0.0, 1.0), window=True),
        ),
        *imaging_subset.commands(
            surface,
            material,
            orthographic_view(right),
            light,
            profile,
            color=parameters["diffuse"],
            ambient=parameters["ambient"],
            specular=parameters["specular"],
            gated=False,
            name="domes",
            triangles_per_polygon=2,
        ),
    )


def scene_evaluated_first(profile, size, **parameters):
    """F004-2 on the future board: the combiners of both passes come before the filter (K16)."""
    return future_board.evaluated_first(scene(profile, size, **parameters))


# One dome as the catalogue's energies are measured: the highlight alone, and a crease of 45 degrees.
CATALOGUED_DOME = {
    **DARK,
    "specular": (1.0, 1.0, 1.0),
    "extent": 1.0,
    "domes": 1,
    "rim_radius": 0.6,
    "rim_slopes": (1.0, 1.0),
    "groove": 0.0,
    "alpha_x": 0.25,
    "alpha_y": 0.25,
    "light": tuple(2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0])),
}
# The catalogue's energies by the texels along a map's edge: of the combiners, of evaluate-then-interpolate.
_CATALOGUED = {32: (0.2574, 7e-4), 64: (0.115, 1e-4), 128: (0.058, 1e-4)}


def checks(figure, renderer):
    """The rings' energies, their brightness, and that they come from interpolation and not from 8 bits."""
    by_method = {EVALUATED_FIRST: _checks_evaluated_first, SQUARED_FIRST: _checks_squared_first}
    return by_method.get(renderer.method.name, _checks_interpolated_first)(figure, renderer)


def _checks_interpolated_first(figure, renderer):
    """The paper's pass: its rings are the catalogue's."""
    size = 512
    for map_size, (expected, software_bound) in _CATALOGUED.items():
        parameters = {**CATALOGUED_DOME, "map_size": map_size}
        ideal = renderer.ideal_window(figure, size, **parameters)[..., 0]
        machine = renderer.machine_window(figure, size, **parameters)[..., 0]
        software, _ = ring_energy(ideal[:, :size], map_size, 0.25, 0.25)
        ideal_energy, ideal_peak = ring_energy(ideal[:, size:], map_size, 0.25, 0.25)
        energy, peak = ring_energy(machine[:, size:], map_size, 0.25, 0.25)
        what = f"{map_size}x{map_size} maps"
        yield Check(
            f"ring energy of evaluate-then-interpolate, {what}",
            software,
            at_most=1.1 * software_bound,
            on=Answer.IDEAL,
            reason="the catalogue's computed energy with 10 % for its rounding to one digit",
        )
        yield Check(
            f"ring energy of the pass against {expected:g}, {what}: relative deviation",
            abs(ideal_energy / expected - 1.0),
            at_most=0.05,
            on=Answer.IDEAL,
            reason="the catalogue's computed energy, printed to two or three digits",
        )
        yield Check(
            f"ring energy, software / combiners, {what}",
            software / energy if energy > 0.0 else float("nan"),
            at_most=0.05,
            on=Answer.MACHINE,
            reason="the catalogue's acceptance: rings stand out against the software renderer",
        )
        yield Check(
            f"brightest ring pixel where the true highlight is zero, {what}",
            peak,
            at_least=0.9,
            on=Answer.MACHINE,
            reason="the catalogue's acceptance: the rings are as bright as a highlight",
        )
        yield Check(
            f"brightest ring pixel where the true highlight is zero, {what}",
            ideal_peak,
            at_least=0.9,
            on=Answer.IDEAL,
            reason="the same without the machine's arithmetic: interpolation alone makes the rings",
        )
        yield Check(
            f"ring energy, machine against ideal, {what}: relative deviation",
            abs(energy / ideal_energy - 1.0),
            at_most=0.05,
            on=Answer.MACHINE,
            reason="the catalogue's acceptance: 8-bit textures must not change the energy by more than "
            "5 %; here with the 9-bit combiners included",
        )


def _checks_evaluated_first(figure, renderer):
    """No rings where the board evaluates first: it draws the software renderer's picture."""
    size = 512
    bounds = {Answer.IDEAL: 1e-9, Answer.MACHINE: 0.0022}
    reasons = {
        Answer.IDEAL: "the same equation on the same texels, in another order of operations",
        Answer.MACHINE: "bytes of t / (4 alpha), times four; measured, with a third of slack",
    }
    for map_size, (_, software_bound) in _CATALOGUED.items():
        parameters = {**CATALOGUED_DOME, "map_size": map_size}
        for on in Answer:
            image = renderer.window(on, figure, size, **parameters)[..., 0]
            energy, _ = ring_energy(image[:, size:], map_size, 0.25, 0.25)
            what = f"{map_size}x{map_size} maps"
            yield Check(
                f"ring energy of the pass, {what}",
                energy,
                at_most=1.1 * software_bound,
                on=on,
                reason="the catalogue's energy of evaluate-then-interpolate, with 10 % for its one digit",
            )
            yield Check(
                f"RMS of the pass - software renderer, {what}",
                root_mean_square(image[:, size:] - image[:, :size]),
                at_most=bounds[on],
                on=on,
                reason=reasons[on],
            )


def _checks_squared_first(figure, renderer):
    """No rings either where squares are made of texels and interpolated, and no vector is."""
    size = 512
    darker = "(.)+ is convex: of interpolated squares it is never more than interpolated (.)+"
    bounds = {
        Answer.IDEAL: (1e-9, darker),
        Answer.MACHINE: (0.5 / 255.0, f"{darker}; half a byte for rounding"),
    }
    for map_size, (_, software_bound) in _CATALOGUED.items():
        parameters = {**CATALOGUED_DOME, "map_size": map_size}
        for on, (bound, reason) in bounds.items():
            image = renderer.window(on, figure, size, **parameters)[..., 0]
            _, software_peak = ring_energy(image[:, :size], map_size, 0.25, 0.25)
            energy, peak = ring_energy(image[:, size:], map_size, 0.25, 0.25)
            what = f"{map_size}x{map_size} maps"
            yield Check(
                f"ring energy of the passes, {what}",
                energy,
                at_most=1.1 * software_bound,
                on=on,
                reason="the catalogue's energy of evaluate-then-interpolate, with 10 % for its one digit",
            )
            yield Check(
                f"brightest ring pixel over the software renderer's, {what}",
                peak - software_peak,
                at_most=bound,
                on=on,
                reason=reason,
            )


FIGURE = Figure(
    id="F004-2",
    title="Rings from interpolating tangents before they are used",
    caption=(
        "Domes of several heights, each in a narrow groove, in the anisotropic Blinn-Phong model with both "
        "alphas 0.25. Slopes jump at the rim and at the groove's outer edge. Left: evaluated at the texels "
        "and interpolated afterwards, in float. Right: register combiners, which interpolate tangents and "
        "binormals first, so that between two texels on either side of a crease vectors point where no "
        "surface does, some of them towards the highlight; on a machine with the imaging subset, squares "
        "that were made while a texture was loaded; on the future board, combiners before the filter."
    ),
    must_see=(
        "The highlights on the domes are alike left and right, and no groove is bright on the left. With "
        "register combiners bright lines follow the grooves on the right: rings round every dome, brightest "
        "towards the light and away from it, faint at right angles to it. The other machines have none."
    ),
    source="KautzSeidel2000",
    techniques=("K07", "K08", "K10", "K16"),
    columns=2,
    parameters={
        "map_size": word.TEXELS(128),
        "alpha_x": word.ALPHA_X(0.25),
        "alpha_y": word.ALPHA_Y(0.25),
        "domes": word.COUNT(4, "Domes along an edge of the square."),
        "rim_radius": word.NUMBER(
            0.75, "The domes' radius.", "half distances of two domes", low=0.1, high=1.0
        ),
        "rim_slopes": word.of(
            word.Several((word.Number(0.1, 8.0),) * 2, what="two numbers from 0.1 to 8"),
            (0.6, 1.0),
            "The slope at the domes' rims, of the lowest dome and of the highest.",
        ),
        "groove": word.NUMBER(
            2.6, "The width of the wall that climbs away from each dome's rim.", "texels", low=0.0, high=16.0
        ),
        "light": word.LIGHT((0.42, 0.29, 0.86)),
        "extent": word.EXTENT(0.9),
        "diffuse": word.DIFFUSE((0.28, 0.31, 0.40)),
        "ambient": word.AMBIENT((0.04, 0.045, 0.06)),
        "specular": word.SPECULAR((0.65, 0.65, 0.60)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the domes", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(0.15),
        "material": own_maps.MATERIAL,
    },
    methods=(
        Method("register combiners", scene, tuple(key for key in COMBINER_MACHINES if key != "FUTURE")),
        Method(EVALUATED_FIRST, scene_evaluated_first, ("FUTURE",)),
        Method(SQUARED_FIRST, imaging_scene, IMAGING_MACHINES),
    ),
    acceptance=checks,
)
