"""F004-2: domes in moats; interpolating tangents before they are used makes rings at the creases."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.acceptance.rings import RING_HALF, ring_energy, rings_round_rims
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, IMAGING_MACHINES, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    orthographic_view,
    row_of_panels,
)
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

DATA = figure_data(__file__, "F004-2")

EVALUATED_FIRST = "evaluation before filtering"
SQUARED_FIRST = "imaging subset"


def rim_radii(i, j, domes, radii):
    """The radius of dome (i, j) of domes x domes, in half distances of two: spread over ``radii``."""
    # Multiples of the golden ratio's fraction: domes that are near each other differ.
    share = ((i + domes * j) * 0.618034) % 1.0
    return radii[0] + (radii[1] - radii[0]) * share


def _domes_material(map_size, alpha_x, alpha_y, k_s, domes, radii, rim_slope, moat, plate):
    """Domes, each with a moat round it that climbs from the rim, ever less, to the level plate between."""
    s, t = (c * domes for c in height_fields.texel_centers(map_size, map_size))
    i, j = np.floor(s), np.floor(t)
    u, v = 2.0 * (s - i) - 1.0, 2.0 * (t - j) - 1.0
    radius, r = rim_radii(i, j, domes, radii), np.sqrt(u * u + v * v)
    # How steep the moat is: 1 at the rim, 0 half way to the next dome, level at both ends.
    q = np.clip((1.0 - r) / (1.0 - radius), 0.0, 1.0)
    steep = q * q * (3.0 - 2.0 * q)
    climb = np.where(r < radius, 0.0, moat * rim_slope * steep)
    inside = height_fields.dome_slopes(s, t, radius, rim_slope)
    slopes = (slope + climb * (c / np.maximum(r, radius)) for slope, c in zip(inside, (u, v), strict=True))
    shine = k_s * (1.0 - (1.0 - plate) * (1.0 - steep * steep))
    return material_textures.from_slopes(*slopes, alpha_x, alpha_y, shine)


def _bumps_material(map_size, alpha_x, alpha_y, k_s, height_field, height_scale, domes):
    if height_field is None:
        return _domes_material(map_size, alpha_x, alpha_y, k_s, **domes)
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
    "radii": (0.6, 0.6),
    "rim_slope": 1.0,
    "moat": 0.0,
    "plate": 1.0,
    "alpha_x": 0.25,
    "alpha_y": 0.25,
    "light": tuple(2.0 * RING_HALF[2] * RING_HALF - np.array([0.0, 0.0, 1.0])),
}
# The catalogue's energies by the texels along a map's edge: of the combiners, of evaluate-then-interpolate.
_CATALOGUED = {32: (0.2574, 7e-4), 64: (0.115, 1e-4), 128: (0.058, 1e-4)}


def checks(figure, renderer):
    """The rings' energies, their brightness, that they come from interpolation and not from 8 bits, and how
    far they go round the domes.
    """
    by_method = {EVALUATED_FIRST: _checks_evaluated_first, SQUARED_FIRST: _checks_squared_first}
    yield from by_method.get(renderer.method.name, _checks_interpolated_first)(figure, renderer)
    yield from _checks_of_the_picture(figure, renderer)
    yield from _checks_by_pixels(figure, renderer)


def _checks_by_pixels(figure, renderer):
    """Both displayed panels against Eq. 1 at every pixel, and what each field does to them."""
    size, values = figure.size, figure.values_of(renderer.method)
    domes = {name: values[name] for name in ("domes", "radii", "rim_slope", "moat", "plate")}
    material = _domes_material(values["map_size"], values["alpha_x"], values["alpha_y"], 1.0, **domes)
    seen = seen_places.square(size, values["extent"])
    interpolated_first = renderer.method.name not in (EVALUATED_FIRST, SQUARED_FIRST)
    textures = material_reference.fields(material)
    left, right = (
        material_reference.pictures(textures, seen, values, gated=False, squared_first=first)
        for first in (True, not interpolated_first)
    )
    return material_reference.checks(DATA, figure, renderer, seen.where, {0: left, 1: right})


def _checks_of_the_picture(figure, renderer):
    """The figure as it is looked at: rings go all round its domes, or there are none."""
    size, values = figure.size, figure.values_of(renderer.method)
    i, j = np.meshgrid(*2 * [np.arange(values["domes"])])
    radii = rim_radii(i, j, values["domes"], values["radii"])
    for on in Answer:
        image = np.clip(renderer.window(on, figure, size)[..., 0], 0.0, 1.0)
        excess = image[:, size:] - image[:, :size]
        shares = rings_round_rims(excess, radii, values["extent"], values["map_size"])
        if renderer.method.name in (EVALUATED_FIRST, SQUARED_FIRST):
            yield DATA.check(
                (
                    "azimuth of a ring where it is brighter than the left panel by 0.2, the largest of "
                    "the domes"
                ),
                float(shares.max()),
                on,
            )
        else:
            yield DATA.check(
                ("azimuth of a ring where it is brighter than the left panel by 0.2, the least of the domes"),
                float(shares.min()),
                on,
            )


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
        yield DATA.check(
            "ring energy of evaluate-then-interpolate, {what}",
            software,
            Answer.IDEAL,
            at_most=1.1 * software_bound,
            what=what,
        )
        yield DATA.check(
            "ring energy of the pass against {expected:g}, {what}: relative deviation",
            abs(ideal_energy / expected - 1.0),
            Answer.IDEAL,
            expected=expected,
            what=what,
        )
        yield DATA.check(
            "ring energy, software / combiners, {what}",
            software / energy if energy > 0.0 else float("nan"),
            Answer.MACHINE,
            what=what,
        )
        yield DATA.check(
            "brightest ring pixel where the true highlight is zero, {what}", peak, Answer.MACHINE, what=what
        )
        yield DATA.check(
            "brightest ring pixel where the true highlight is zero, {what}",
            ideal_peak,
            Answer.IDEAL,
            what=what,
        )
        yield DATA.check(
            "ring energy, machine against ideal, {what}: relative deviation",
            abs(energy / ideal_energy - 1.0),
            Answer.MACHINE,
            what=what,
        )


def _checks_evaluated_first(figure, renderer):
    """No rings where the board evaluates first: it draws the software renderer's picture."""
    size = 512
    for map_size, (_, software_bound) in _CATALOGUED.items():
        parameters = {**CATALOGUED_DOME, "map_size": map_size}
        for on in Answer:
            image = renderer.window(on, figure, size, **parameters)[..., 0]
            energy, _ = ring_energy(image[:, size:], map_size, 0.25, 0.25)
            what = f"{map_size}x{map_size} maps"
            yield DATA.check(
                "ring energy of the pass, {what}", energy, on, at_most=1.1 * software_bound, what=what
            )
            yield DATA.check(
                "RMS of the pass - software renderer, {what}",
                root_mean_square(image[:, size:] - image[:, :size]),
                on,
                what=what,
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
            yield DATA.check(
                "ring energy of the passes, {what}", energy, on, at_most=1.1 * software_bound, what=what
            )
            yield Check(
                f"brightest ring pixel over the software renderer's, {what}",
                peak - software_peak,
                at_most=bound,
                on=on,
                reason=reason,
            )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "map_size": word.TEXELS(128),
        "alpha_x": word.ALPHA_X(0.4),
        "alpha_y": word.ALPHA_Y(0.4),
        "domes": word.COUNT(3, "Domes along an edge of the square."),
        "radii": word.of(
            word.Several((word.Number(0.1, 0.95),) * 2, what="two numbers from 0.1 to 0.95"),
            (0.47, 0.72),
            "The radius of the smallest dome and of the largest.",
            "half distances of two domes",
        ),
        "rim_slope": word.NUMBER(0.84, "The slope at the domes' rims.", "1 = 45 degrees", low=0.1, high=8.0),
        "moat": word.SHARE(
            0.8, "How steeply the moat round each dome climbs from the rim, over rim_slope; 0 is none."
        ),
        "plate": word.SHARE(
            0.0, "The strength of highlights on the level plate between the moats, over that on the domes."
        ),
        "light": word.LIGHT((0.24, 0.16, 0.98)),
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
