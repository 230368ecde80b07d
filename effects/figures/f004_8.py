"""F004-8: the same bumps in three reflectance models: Banks, anisotropic Blinn-Phong, Ward."""

import numpy as np

from effects import (
    anisotropic_blinn_phong,
    brdfs,
    diffuse_bump,
    evaluate_then_interpolate,
    height_fields,
    material_textures,
    meshes,
)
from effects.encode import encode_factor
from effects.figures.figure import BACKGROUND, DARK, Check, Figure, Method
from effects.figures.measures import pixel_grid, root_mean_square
from effects.passes import show
from effects.vectors import normalize
from effects.views import Light, orthographic_view, row_of_panels

# The direction to the viewer, who is far away.
VIEW = np.array([0.0, 0.0, 1.0])
# From left to right.
MODELS = ("Banks", "Blinn-Phong", "Ward")
_MATERIAL = ("map_size", "bumps", "depth", "alpha_x", "alpha_y", "spread", "stroke_depth", "k_s")


def bumpy_material(map_size, bumps, depth, alpha_x, alpha_y, spread, stroke_depth, k_s):
    """The slightly brushed bump map of all three panels."""
    return material_textures.brushed_bumps(
        *height_fields.pebble_slopes(map_size, bumps, depth),
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


def _software_image(
    model, material, light, panel, profile, *, diffuse, ambient, specular, background, extent
):
    """What a software renderer shows on a panel: evaluated at the texels, then interpolated."""
    x, y = pixel_grid(panel.width, extent)
    s, t = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
    toward = normalize(np.array(light))
    lit = evaluate_then_interpolate.diffuse(material, toward, s, t)[..., None] * np.array(diffuse)
    at_texels = radiance(model, material, light)
    values = evaluate_then_interpolate.at_texels(lambda i, j: at_texels[i, j], *at_texels.shape, s, t)
    picture = (lit + np.array(ambient)) + values[..., None] * np.array(specular)
    covered = (np.maximum(np.abs(x), np.abs(y)) < 1.0)[..., None]
    picture = encode_factor(np.clip(np.where(covered, picture, np.array(background)), 0.0, 1.0), profile)
    return show(picture, panel, f"software renderer's image: {model}", meshes.plane())


def combiners_scene(
    profile, size, *, map_size, bumps, depth, alpha_x, alpha_y, spread, stroke_depth, k_s, light, extent,
    diffuse, ambient, banks, blinn_phong, ward, background,
):  # fmt: skip
    """As the paper did: Banks and Ward in the software renderer, Blinn-Phong by register combiners."""
    panels = row_of_panels(3, size)
    material = bumpy_material(map_size, bumps, depth, alpha_x, alpha_y, spread, stroke_depth, k_s)
    colors = {"diffuse": diffuse, "ambient": ambient, "background": background, "extent": extent}
    loading, names = material_textures.load(material, "brushed bumps", profile)
    surface, view, toward = meshes.plane(1, 1, extent, extent), orthographic_view(panels[1]), Light(light)
    return (
        *(panel.clear(background) for panel in panels),
        *_software_image("Banks", material, light, panels[0], profile, specular=banks, **colors),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, toward, profile, color=diffuse, ambient=ambient
        ),
        *anisotropic_blinn_phong.specular_pass(surface, names, view, toward, profile, specular=blinn_phong),
        *_software_image("Ward", material, light, panels[2], profile, specular=ward, **colors),
    )


_SOFTWARE = "float64 throughout; the texels' model is shown texel for pixel"
_BYTE = "float64 until its picture is stored in bytes: a step's uniform error, 0.29/255, and no more"
IN_COMBINERS = "register combiners; Banks and Ward in software, as in the paper"
# RMS from the models by method, on the ideal and on the machine, with the reasons.
_BOUNDS = {
    IN_COMBINERS: {
        "ideal": {
            "Banks": (1e-12, _SOFTWARE),
            "Blinn-Phong": (1e-12, "the pass is Eq. 1; a texel lies under each pixel's centre"),
            "Ward": (1e-12, _SOFTWARE),
        },
        "machine": {
            "Banks": (0.0012, _BYTE),
            "Blinn-Phong": (
                0.02,
                "9-bit combiners, vectors of bytes, times four: artefact P9's 0.015-0.018",
            ),
            "Ward": (0.0012, _BYTE),
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

    ``image`` as above, with Banks's model; where |l.t| <= 0.5 and n.l >= 0.5, in steps of l.t of 1/256.
    """
    cosine, lit = material.tangents[..., 2], material.normals[..., 2]
    chosen = (np.abs(cosine) <= 0.5) & (lit >= 0.5)
    bracket, cone = (image / np.where(lit > 0.0, lit, 1.0))[chosen], np.floor(256 * cosine[chosen])
    worst = 0.0
    for c in np.unique(cone):
        of_one = bracket[cone == c]
        worst = max(worst, float(np.abs(of_one / of_one.mean() - 1.0).max()))
    return worst


def checks(figure, renderer):
    """Shapes of the three highlights, and each panel against its model in float."""
    parameters = {**figure.parameters, **renderer.method.parameters, **_MEASURED}
    size, out = parameters["map_size"], []
    material = bumpy_material(**{name: parameters[name] for name in _MATERIAL})
    expected = parameters["alpha_x"] / parameters["alpha_y"]
    bounds = _BOUNDS[renderer.method.name]
    for on in ("ideal", "machine"):
        image = getattr(renderer, on)(figure, size, **_MEASURED)[..., 0]
        panels = {name: image[:, k * size : (k + 1) * size] for k, name in enumerate(MODELS)}
        for name in ("Blinn-Phong", "Ward"):
            ratio = highlight_ratio(panels[name], material)
            out.append(
                Check(
                    f"{name}: half widths of the highlight over alpha_x / alpha_y, relative deviation",
                    abs(ratio / expected - 1.0),
                    "<=",
                    0.1,
                    on,
                    "the catalogue's acceptance",
                )
            )
        if on == "ideal":
            out.append(
                Check(
                    "Banks: deviation from constant on the cones l.t = -v.t",
                    cone_deviation(panels["Banks"], material),
                    "<=",
                    0.02,
                    on,
                    "the catalogue's acceptance; a step of the cones is 1/256",
                )
            )
        for name in MODELS:
            true = np.clip(radiance(name, material, _MEASURED["light"]), 0.0, 1.0)
            error = root_mean_square(np.clip(panels[name], 0.0, 1.0) - true)
            bound, reason = bounds[on][name]
            out.append(Check(f"{name}: RMS from the model in float", error, "<=", bound, on, reason))
    return tuple(out)


FIGURE = Figure(
    id="F004-8",
    title="The same bumps in three reflectance models",
    caption=(
        "One square with a slightly brushed bump map, lit from the upper right: Banks's model (left), the "
        "anisotropic Blinn-Phong model (middle), Ward's (right)."
    ),
    must_see=(
        "The same bumps three times. Banks: broad bands of light across the brushing, as bright far from the "
        "light's side. Blinn-Phong and Ward: highlights narrow along the brushing and drawn out across it, "
        "alike in shape, Ward's with soft edges."
    ),
    source="KautzSeidel2000",
    techniques=("K03", "K07", "K09", "K10", "K20"),
    columns=3,
    size=384,
    parameters={
        "map_size": 256,
        "bumps": 6,
        "depth": 0.75,
        "alpha_x": 0.2,
        "alpha_y": 0.5,
        "spread": 6.0,
        "stroke_depth": 0.08,
        "k_s": (0.75, 1.0),
        "light": (0.75, 0.45, 1.0),
        "extent": 0.92,
        "diffuse": (0.26, 0.29, 0.34),
        "ambient": (0.02, 0.025, 0.035),
        "banks": (0.56, 0.54, 0.49),
        "blinn_phong": (0.74, 0.72, 0.66),
        "ward": (1.0, 0.97, 0.90),
        "background": BACKGROUND,
    },
    methods=(
        Method(
            IN_COMBINERS,
            combiners_scene,
            ("GEFORCE_256",),
            # The combiners' storage bounds alpha by 0.25; the ratio stays.
            {"alpha_x": 0.25, "alpha_y": 0.625},
        ),
    ),
    acceptance=checks,
)
