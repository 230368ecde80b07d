"""F004-8: the same bumps in three reflectance models: Banks, anisotropic Blinn-Phong, Ward."""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance import material_reference, seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Light,
    Panel,
    orthographic_view,
    row_of_panels,
)
from fixedpipe.effects.passes.draws import ADD, LATER_PASS, show
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    brdfs,
    dependent_lookups,
    dot_product_lookups,
    evaluate_then_interpolate,
    future_board,
    material_textures,
    pixel_textures,
)

DATA = figure_data(__file__, "F004-8")

# The direction to the viewer, who is far away.
VIEW = np.array([0.0, 0.0, 1.0])
# From left to right.
MODELS = ("Banks", "Blinn-Phong", "Ward")
# Up to which 1/sqrt(p) the tables of Ward's model go: no pebble is so steep that it takes more.
LARGEST_S = 2.0
_MATERIAL = ("map_size", "bumps", "depth", "alpha_x", "alpha_y", "spread", "stroke_depth", "k_s")


def bumpy_material(
    *,
    map_size,
    bumps,
    depth,
    alpha_x,
    alpha_y,
    spread,
    stroke_depth,
    k_s,
    height_field=None,
    height_scale=0.0,
):
    """The slightly brushed bump map of all three panels: of pebbles, or of a height field."""
    if height_field is None:
        slopes = height_fields.pebble_slopes(map_size, bumps, depth)
    else:
        slopes = height_field.slopes(map_size, height_scale, repeated=False)
    return material_textures.brushed_bumps(
        *slopes,
        alpha_x=alpha_x,
        alpha_y=alpha_y,
        spread=spread,
        stroke_depth=stroke_depth,
        k_s=k_s,
    )


def radiance(model, material, light):
    """A model at every texel, float64 [rows, columns], under a directional light and a viewer far away.

    ``model``: "Banks", "Blinn-Phong" (Eq. 1) or "Ward".
    """
    m, light = material, normalize(np.array(light))
    if model == "Banks":
        return brdfs.banks(light, VIEW, m.normals, m.tangents, m.k_s)
    if model == "Blinn-Phong":
        half = brdfs.half_vector(light, VIEW)
        return brdfs.anisotropic_blinn_phong(half, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s)
    return brdfs.ward(light, VIEW, m.normals, m.tangents, m.binormals, m.alpha_x, m.alpha_y, m.k_s)


@dataclass(frozen=True)
class _Square:
    """What is drawn three times, side by side, with a color of each model's highlights."""

    profile: object
    panels: tuple[Panel, ...]
    material: material_textures.Material
    surface: surfaces.Surface
    light: Light
    extent: float
    diffuse: tuple[float, float, float]
    ambient: tuple[float, float, float]
    colors: dict[str, tuple[float, float, float]]
    background: tuple[float, float, float]

    @property
    def cleared(self):
        """The commands that clear the panels."""
        return tuple(panel.clear(self.background) for panel in self.panels)

    def diffuse_pass(self, normal_map, panel, **settings):
        """K10 by register combiners on a panel."""
        return diffuse_bump.diffuse_pass(
            self.surface,
            normal_map,
            orthographic_view(panel),
            self.light,
            self.profile,
            color=self.diffuse,
            ambient=self.ambient,
            **settings,
        )


def _square(
    profile, size, *, light, extent, diffuse, ambient, banks, blinn_phong, ward, background, material,
    height_field, **of_bumps,
):  # fmt: skip
    material = own_maps.material_or(
        lambda: bumpy_material(height_field=height_field, **of_bumps), material, height_field
    )
    return _Square(
        profile=profile,
        panels=row_of_panels(3, size),
        material=material,
        surface=surfaces.plane(1, 1, extent, extent),
        light=Light(light),
        extent=extent,
        diffuse=diffuse,
        ambient=ambient,
        colors=dict(zip(MODELS, (banks, blinn_phong, ward), strict=True)),
        background=background,
    )


def _software_image(square, model, panel):
    """What a software renderer shows on a panel: evaluated at the texels, then interpolated."""
    x, y = pixel_grid(panel.width, square.extent)
    s, t = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
    light = square.light.vector
    lit = evaluate_then_interpolate.diffuse(square.material, normalize(np.array(light)), s, t)
    at_texels = radiance(model, square.material, light)
    values = evaluate_then_interpolate.at_texels(lambda i, j: at_texels[i, j], *at_texels.shape, s, t)
    picture = lit[..., None] * np.array(square.diffuse) + np.array(square.ambient)
    picture = picture + values[..., None] * np.array(square.colors[model])
    covered = (np.maximum(np.abs(x), np.abs(y)) < 1.0)[..., None]
    picture = np.clip(np.where(covered, picture, np.array(square.background)), 0.0, 1.0)
    stored = factor_texels(picture, square.profile)
    return show(stored, panel, f"software renderer's image: {model}", surfaces.plane())


def combiners_scene(profile, size, **parameters):
    """As the paper did: Banks and Ward in the software renderer, Blinn-Phong by register combiners (K07)."""
    square = _square(profile, size, **parameters)
    left, middle, right = square.panels
    loading, names = material_textures.load(square.material, "brushed bumps", profile)
    return (
        *square.cleared,
        *_software_image(square, "Banks", left),
        *loading,
        *square.diffuse_pass(names.normal, middle),
        *anisotropic_blinn_phong.specular_pass(
            square.surface,
            names,
            orthographic_view(middle),
            square.light,
            profile,
            specular=square.colors["Blinn-Phong"],
        ),
        *_software_image(square, "Ward", right),
    )


def texture_shaders_scene(profile, size, **parameters):
    """Banks and Blinn-Phong by dot products that look a table up, Ward by parameters on the screen (K01)."""
    square = _square(profile, size, **parameters)
    left, middle, right = square.panels
    banks_loading, banks = dot_product_lookups.load_banks(square.material, "Banks", profile)
    blinn_phong_loading, blinn_phong = dot_product_lookups.load_blinn_phong(
        square.material, "Blinn-Phong", profile
    )
    ward_loading, ward = dependent_lookups.load(square.material, "Ward", profile)
    normal_map, normals = material_textures.load_normals(square.material, "brushed bumps", profile)

    def specular_pass(passes, loaded, panel, model, **options):
        view, color = orthographic_view(panel), square.colors[model]
        return passes(square.surface, loaded, view, square.light, profile, specular=color, **options)

    return (
        *square.cleared,
        *banks_loading,
        *blinn_phong_loading,
        *ward_loading,
        *dependent_lookups.load_ward_functions(profile, largest_s=LARGEST_S),
        dependent_lookups.load_screen(right),
        normal_map,
        *square.diffuse_pass(normals, left),
        *specular_pass(dot_product_lookups.banks_pass, banks, left, "Banks"),
        *square.diffuse_pass(normals, middle),
        *specular_pass(dot_product_lookups.blinn_phong_pass, blinn_phong, middle, "Blinn-Phong"),
        *specular_pass(dependent_lookups.ward_passes, ward, right, "Ward", largest_s=LARGEST_S),
        *square.diffuse_pass(normals, right, depth_test=LATER_PASS, blending=ADD),
    )


def pixel_textures_scene(profile, size, **parameters):
    """All three by pixel textures (K15); the diffuse pass by the color matrix, added afterwards."""
    square = _square(profile, size, **parameters)
    passes = (
        (pixel_textures.banks, {}),
        (pixel_textures.blinn_phong, {"gated": True}),
        (pixel_textures.ward, {"largest_s": LARGEST_S}),
    )
    out = [*square.cleared]
    for panel, model, (specular_passes, options) in zip(square.panels, MODELS, passes, strict=True):
        drawn = square.surface, square.material, orthographic_view(panel), square.light, profile
        out += specular_passes(*drawn, specular=square.colors[model], **options)
        out += pixel_textures.diffuse(*drawn, color=square.diffuse, ambient=square.ambient)
    return tuple(out)


def future_scene(profile, size, **parameters):
    """All three by combiners that take square roots, divide and exponentiate (K17)."""
    square = _square(profile, size, **parameters)
    loading, names = future_board.load(square.material, "brushed bumps", profile)
    out = [*square.cleared, *loading]
    passes = (future_board.banks, future_board.blinn_phong, future_board.ward)
    for panel, color, specular_pass in zip(square.panels, square.colors.values(), passes, strict=True):
        out += square.diffuse_pass(names.normal, panel)
        out += specular_pass(
            square.surface, names, orthographic_view(panel), square.light, profile, specular=color
        )
    return tuple(out)


_SOFTWARE = "float64 throughout; the texels' model is shown texel for pixel"
_BYTE = "float64 until its picture is stored in bytes: a step's uniform error, 0.29/255, and no more"
_THE_MODEL = "the combiners compute the printed model; a texel lies under each pixel's centre"
_VECTORS = (
    "material textures of bytes, read at 16 bits; divided by alpha they have coarser steps; measured at the "
    "first correct picture, with a third of slack"
)
_TABLES = "tables of 256 texels, linear between them; measured at the first correct picture, a third of slack"
_BYTES = (
    "vectors, tables and parameters on the screen are bytes; measured at the first correct picture, a third "
    "of slack"
)
_PASSES = (
    "a byte is stored by each of several passes, of products and not of vectors; measured at the first "
    "correct picture, a third of slack"
)
IN_COMBINERS = "register combiners; Banks and Ward in software, as in the paper"
BY_TEXTURE_SHADERS = "texture shaders: dot products and dependent lookups"
BY_PIXEL_TEXTURES = "pixel textures"
ON_THE_FUTURE_BOARD = "combiners with square root, division, exponential"
# RMS from the models by method, on the ideal and on the machine, with the reasons.
_BOUNDS = {
    IN_COMBINERS: {
        Answer.IDEAL: {
            "Banks": (1e-12, _SOFTWARE),
            "Blinn-Phong": (1e-12, _THE_MODEL),
            "Ward": (1e-12, _SOFTWARE),
        },
        Answer.MACHINE: {
            "Banks": (0.0012, _BYTE),
            "Blinn-Phong": (
                0.02,
                "9-bit combiners, vectors of bytes, times four: artefact P9's 0.015-0.018",
            ),
            "Ward": (0.0012, _BYTE),
        },
    },
    BY_TEXTURE_SHADERS: {
        Answer.IDEAL: {"Banks": (6e-5, _TABLES), "Blinn-Phong": (2.2e-4, _TABLES), "Ward": (1.2e-3, _TABLES)},
        Answer.MACHINE: {
            "Banks": (0.0055, _BYTES),
            "Blinn-Phong": (0.0097, _BYTES),
            "Ward": (0.0114, _BYTES),
        },
    },
    BY_PIXEL_TEXTURES: {
        Answer.IDEAL: {"Banks": (6e-5, _TABLES), "Blinn-Phong": (1.5e-4, _TABLES), "Ward": (2.8e-4, _TABLES)},
        Answer.MACHINE: {
            "Banks": (0.0042, _PASSES),
            "Blinn-Phong": (0.0023, _PASSES),
            "Ward": (0.006, _PASSES),
        },
    },
    ON_THE_FUTURE_BOARD: {
        Answer.IDEAL: {
            "Banks": (1e-12, _THE_MODEL),
            "Blinn-Phong": (0.00022, "the logarithm is a polynomial; measured, with a third of slack"),
            "Ward": (1e-12, _THE_MODEL),
        },
        Answer.MACHINE: {
            "Banks": (0.004, _VECTORS),
            "Blinn-Phong": (0.0158, _VECTORS),
            "Ward": (0.0088, _VECTORS),
        },
    },
}

# The figure with a texel under each pixel's centre, light and viewer above, and nothing but the highlights.
_MEASURED = {
    **DARK,
    **dict.fromkeys(("banks", "blinn_phong", "ward"), (1.0, 1.0, 1.0)),
    "spread": 0.0,
    "stroke_depth": 0.0,
    "k_s": (1.0, 1.0),
    "extent": 1.0,
    "light": (0.0, 0.0, 1.0),
}


def half_maximum(across, value):
    """Where a lobe that falls from its greatest value at zero has half of it: a number like ``across``.

    ``across``, ``value``: float64 [n]: distances from the lobe's axis, of one sign, and intensities.
    """
    order = np.argsort(across, kind="stable")
    across, value = across[order], value[order]
    below = int(np.argmax(value < 0.5 * value.max()))
    if below == 0:
        return float("nan")
    f = (value[below - 1] - 0.5 * value.max()) / (value[below - 1] - value[below])
    return float(across[below - 1] + f * (across[below] - across[below - 1]))


def highlight_ratio(image, material):
    """Half width of a highlight along the tangents over that along the binormals, in sines of the half
    vector.

    ``image``: float64 [rows, columns], a pixel per texel, lit and seen along z.
    """
    along_t, along_b = np.abs(material.tangents[..., 2]), np.abs(material.binormals[..., 2])
    near = 0.03
    widths = (
        half_maximum(one[other < near], image[other < near])
        for one, other in ((along_t, along_b), (along_b, along_t))
    )
    return next(widths) / next(widths)


def cone_deviation(image, material):
    """How far Banks's lobe is from constant on each cone l.t = -v.t: the largest relative deviation from its
    mean.

    ``image`` as above, with Banks's model; compared where |l.t| <= 0.5 and n.l >= 0.5, in steps of l.t of
    1/256.
    """
    cosine, lit = material.tangents[..., 2], material.normals[..., 2]
    chosen = (np.abs(cosine) <= 0.5) & (lit >= 0.5)
    bracket, cone = (image / np.where(lit > 0.0, lit, 1.0))[chosen], np.floor(256 * cosine[chosen])
    worst = 0.0
    for c in np.unique(cone):
        of_one = bracket[cone == c]
        worst = max(worst, float(np.abs(of_one / of_one.mean() - 1.0).max()))
    return worst


def _checks_by_pixels(figure, renderer):
    """The displayed middle panel against Eq. 1 at every pixel, and what each field does to it."""
    size, values = figure.size, figure.values_of(renderer.method)
    material = bumpy_material(**{name: values[name] for name in _MATERIAL})
    seen = seen_places.square(size, values["extent"])
    found = material_reference.pictures(
        material_reference.fields(material),
        seen,
        {**values, "specular": values["blinn_phong"]},
        squared_first=renderer.method.name == BY_PIXEL_TEXTURES,
    )
    return material_reference.checks(DATA, figure, renderer, seen.where, {1: found})


def checks(figure, renderer):
    """The middle panel pixel by pixel; shapes of the three highlights; each panel against its model."""
    yield from _checks_by_pixels(figure, renderer)
    parameters = {**figure.values_of(renderer.method), **_MEASURED}
    size = parameters["map_size"]
    material = bumpy_material(**{name: parameters[name] for name in _MATERIAL})
    expected = parameters["alpha_x"] / parameters["alpha_y"]
    bounds = _BOUNDS[renderer.method.name]
    for on in Answer:
        image = renderer.window(on, figure, size, **_MEASURED)[..., 0]
        panels = {name: image[:, k * size : (k + 1) * size] for k, name in enumerate(MODELS)}
        for name in ("Blinn-Phong", "Ward"):
            ratio = highlight_ratio(panels[name], material)
            yield DATA.check(
                "{name}: half widths of the highlight over alpha_x / alpha_y, relative deviation",
                abs(ratio / expected - 1.0),
                on,
                name=name,
            )
        if on is Answer.IDEAL:
            yield DATA.check(
                "Banks: deviation from constant on the cones l.t = -v.t",
                cone_deviation(panels["Banks"], material),
                on,
            )
        for name in MODELS:
            true = np.clip(radiance(name, material, _MEASURED["light"]), 0.0, 1.0)
            error = root_mean_square(np.clip(panels[name], 0.0, 1.0) - true)
            bound, reason = bounds[on][name]
            yield Check(f"{name}: RMS from the model in float", error, at_most=bound, on=on, reason=reason)


FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "map_size": word.TEXELS(256),
        "bumps": word.EVEN(6, "Pebbles along an edge of the square."),
        "depth": word.SLOPE(0.75, "The pebbles' height over half balls."),
        "alpha_x": word.ALPHA_X(0.2),
        "alpha_y": word.ALPHA_Y(0.5),
        "spread": word.SPREAD(6.0),
        "stroke_depth": word.STROKE_DEPTH(0.08),
        "k_s": word.K_S((0.75, 1.0)),
        "light": word.LIGHT((0.75, 0.45, 1.0)),
        "extent": word.EXTENT(0.92),
        "diffuse": word.DIFFUSE((0.26, 0.29, 0.34)),
        "ambient": word.AMBIENT((0.02, 0.025, 0.035)),
        "banks": word.SPECULAR((0.56, 0.54, 0.49), "The colour of the highlights by Banks's model."),
        "blinn_phong": word.SPECULAR((0.74, 0.72, 0.66), "The colour of the highlights by Eq. 1."),
        "ward": word.SPECULAR((1.0, 0.97, 0.90), "The colour of the highlights by Ward's model."),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles", repeats=False),
        "height_scale": own_maps.HEIGHT_SCALE(
            0.05,
            "How far the highest point of height_field stands above the lowest, in widths of it. Where it is "
            "so steep that (n.l)(n.v) is below 1/4, Ward's model by tables is dimmer than it should be.",
        ),
        "material": own_maps.MATERIAL,
    },
    methods=(
        Method(
            IN_COMBINERS,
            combiners_scene,
            ("GEFORCE_256",),
            # The combiners' storage bounds alpha by 0.25; the ratio stays.
            {"alpha_x": 0.25, "alpha_y": 0.625},
        ),
        Method(BY_TEXTURE_SHADERS, texture_shaders_scene, ("GEFORCE_3", "NV2A")),
        Method(BY_PIXEL_TEXTURES, pixel_textures_scene, ("OCTANE",)),
        Method(ON_THE_FUTURE_BOARD, future_scene, ("FUTURE",)),
    ),
    acceptance=checks,
)
