"""K24: other models that fit the scheme: Phong with N per pixel, Schlick, one lobe of Lafortune."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import principal_axis, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cosine, cross, dot, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import (
    dependent_lookups,
    material_textures,
    phong_schlick_lafortune,
    phong_schlick_lafortune_copies,
)
from fixedpipe.effects.reflectance.brdfs import BRDFS, Frame

DATA = figure_data(__file__, "K24")

# The direction to the viewer, who is far away.
VIEW = np.array([0.0, 0.0, 1.0])
# From left to right.
MODELS = ("Phong", "Schlick", "Lafortune")
_MATERIAL = ("map_size", "domes", "rim", "exponents", "brushing", "k_s")
_SHOWN = ("diffuse", "ambient", "background", "specular")
BY_TEXTURE_SHADERS, BY_PIXEL_TEXTURES = "texture shaders", "pixel textures"


def domed_material(map_size, domes, rim, exponents, brushing, k_s):
    """``domes`` x ``domes`` domes of k_s on a dull plate.

    Each dome, row by row from the lower left, has its own N from ``exponents``, and is brushed along its own
    angle from ``brushing``, degrees from the s axis.
    """
    s, t = height_fields.texel_centers(map_size, map_size)
    normals, _, _ = height_fields.frames(*height_fields.dome_slopes(s * domes, t * domes, rim))
    dome = (np.floor(t * domes) * domes + np.floor(s * domes)).astype(int)
    angles = np.radians(np.array(brushing))[dome]
    along = np.stack([cosine(angles), sine(angles), np.zeros(angles.shape)], axis=-1)
    tangents = normalize(along - dot(along, normals)[..., None] * normals)
    u, v = (2.0 * (c * domes - np.floor(c * domes)) - 1.0 for c in (s, t))
    # Two texels within the rim: the filter never mixes a shining texel with the plate's.
    reach = rim - 4.0 * domes / map_size
    gloss = np.where(u * u + v * v < reach * reach, k_s, 0.0)
    return material_textures.Material(
        normals, tangents, cross(normals, tangents), 1.0, 1.0, gloss, exponent=np.array(exponents)[dome]
    )


def _parts(size, parameters):
    material = domed_material(**{name: parameters[name] for name in _MATERIAL})
    extent = parameters["extent"]
    surface, toward = surfaces.plane(1, 1, extent, extent), Light(parameters["light"])
    shown = {
        "color": parameters["diffuse"],
        "ambient": parameters["ambient"],
        "background": parameters["background"],
    }
    panels = row_of_panels(3, size)
    return material, surface, toward, shown, [orthographic_view(panel) for panel in panels]


def texture_shaders_scene(profile, size, **parameters):
    """The three models by texture shaders."""
    material, surface, toward, shown, views = _parts(size, parameters)
    models = phong_schlick_lafortune
    loading, names = models.load(material, "domes", profile, parameters["coefficients"])
    given = [(surface, names, view, toward, profile) for view in views]
    return (
        *loading,
        dependent_lookups.load_screen(views[0].panel),
        *models.phong_passes(*given[0], specular=parameters["phong"], **shown),
        *models.schlick_passes(
            *given[1],
            roughness=parameters["roughness"],
            isotropy=parameters["isotropy"],
            reflectance=parameters["reflectance"],
            specular=parameters["schlick"],
            **shown,
        ),
        *models.lafortune_passes(
            *given[2], exponent=parameters["exponent"], specular=parameters["lafortune"], **shown
        ),
    )


def pixel_textures_scene(profile, size, **parameters):
    """The three models by pixel textures."""
    material, surface, toward, shown, views = _parts(size, parameters)
    models = phong_schlick_lafortune_copies
    given = [(surface, material, view, toward, profile) for view in views]
    return (
        *models.phong_copies(*given[0], specular=parameters["phong"], **shown),
        *models.schlick_copies(
            *given[1],
            roughness=parameters["roughness"],
            isotropy=parameters["isotropy"],
            reflectance=parameters["reflectance"],
            specular=parameters["schlick"],
            **shown,
        ),
        *models.lafortune_copies(
            *given[2],
            coefficients=parameters["coefficients"],
            exponent=parameters["exponent"],
            specular=parameters["lafortune"],
            **shown,
        ),
    )


def radiance(model, parameters):
    """A model in float at every texel, [rows, columns]: what its panel shows of the highlights alone."""
    material = domed_material(**{name: parameters[name] for name in _MATERIAL})
    light = normalize(np.array(parameters["light"]))
    frame = Frame(material.normals, material.tangents, material.binormals)
    given = {
        "Phong": {"exponent": material.exponent},
        "Schlick": {
            "roughness": parameters["roughness"],
            "isotropy": parameters["isotropy"],
            "specular": parameters["reflectance"],
        },
        "Lafortune": {"coefficients": parameters["coefficients"], "exponent": parameters["exponent"]},
    }[model]
    return material.k_s * BRDFS[model.lower()].radiance(light, VIEW, frame, **given)


# A texel under each pixel's centre, and only the highlights to be seen.
_MEASURED = {**DARK, **dict.fromkeys(("phong", "schlick", "lafortune"), (1.0, 1.0, 1.0)), "extent": 1.0}

_TABLES = "the catalogue's acceptance of dependent tables of 256 x 256 texels (F004-1)"
# RMS from the models on machines, where it is not the tables' own bound, with the reason.
_BOUNDS = {
    (BY_PIXEL_TEXTURES, "Phong"): (
        0.0125,
        "n.l and n.v are bytes in a texture, in the fragment and in the framebuffer, which leaves "
        "c = 2 (n.l)(n.v) - l.v off by 1/300, and N multiplies that; measured at the first correct picture, "
        "a third of slack",
    )
}


def _rims_check(figure, renderer):
    """What the displayed panels show round the domes, where no highlight is."""
    values, size = figure.values_of(renderer.method), figure.size
    material = domed_material(**{name: values[name] for name in _MATERIAL})
    seen = seen_places.square(size, values["extent"])
    u, v = (2.0 * (c * values["domes"] % 1.0) - 1.0 for c in (seen.s, seen.t))
    # From a texel beyond the shining ones to a tenth beyond the rim.
    radius, texel = np.hypot(u, v), 2.0 * values["domes"] / values["map_size"]
    beside = (radius > values["rim"] - texel) & (radius < values["rim"] + 0.1)
    normals = seen_places.looked_up(material.normals, seen)[beside]
    lit = np.maximum(normals @ normalize(np.array(values["light"])), 0.0)[:, None]
    where = seen.where.copy()
    where[seen.where] = beside
    expected = where, lit * np.array(values["diffuse"]) + np.array(values["ambient"])
    for on, share in seen_places.shares_alike(figure, renderer, dict.fromkeys(range(3), expected)):
        yield DATA.check(
            "round the domes: pixels with (n.l)+ alone within 8/255, the least of the panels", share, on
        )


def checks(figure, renderer):
    """The panels against their models in float, and what must be seen in rows of domes."""
    yield from _rims_check(figure, renderer)
    parameters = {**figure.values_of(renderer.method), **_MEASURED}
    size, domes, exponents = (parameters[k] for k in ("map_size", "domes", "exponents"))
    shines = domed_material(**{name: parameters[name] for name in _MATERIAL}).k_s > 0.0
    rows = [slice(k * size // domes, (k + 1) * size // domes) for k in range(domes)]
    caps = 1.0 - 0.5 ** (1.0 / np.array(exponents))
    for on in Answer:
        image = np.clip(renderer.window(on, figure, size, **_MEASURED)[..., 0], 0.0, 1.0)
        panels = {name: image[:, k * size : (k + 1) * size] for k, name in enumerate(MODELS)}
        for name, panel in panels.items():
            true = np.clip(radiance(name, parameters), 0.0, 1.0)
            bound, reason = 1.0 / 128.0, _TABLES
            if on is Answer.MACHINE:
                bound, reason = _BOUNDS.get((renderer.method.name, name), (bound, reason))
            error = root_mean_square((panel - true)[shines])
            yield Check(
                f"{name}: RMS from the model in float, on the domes",
                error,
                at_most=bound,
                on=on,
                reason=reason,
            )
        areas = [float((panels["Phong"][row] > 0.5).mean()) for row in rows]
        expected = caps[:domes].sum() / caps[-domes:].sum()
        yield DATA.check(
            "Phong: area above one half, lowest row of domes over highest, relative deviation",
            abs(areas[0] / areas[-1] / expected - 1.0),
            on,
        )
        for k, angle in enumerate(parameters["brushing"]):
            dome = panels["Schlick"][rows[k // domes], rows[k % domes]]
            lies, _ = principal_axis(np.where(dome > 0.5 * dome.max(), dome, 0.0))
            yield DATA.check(
                "Schlick: angle of the highlight to the brushing along {angle:g} degrees, off 90",
                abs((lies - angle) % 180.0 - 90.0),
                on,
                angle=angle,
            )


FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "map_size": word.TEXELS(256),
        "domes": word.internal(3, "There are as many domes as exponents and brushing directions, nine."),
        "rim": word.NUMBER(0.9, "The radius of the domes, over half the distance of two.", low=0.1, high=1.0),
        "exponents": word.of(
            word.Several((word.EXPONENT_KIND,) * 9),
            (4.0, 5.0, 7.0, 9.0, 11.0, 15.0, 19.0, 25.0, 32.0),
            "The exponent N of each of Phong's domes, row by row from the lower left.",
        ),
        "brushing": word.of(
            word.Several((word.Number(-180.0, 180.0),) * 9),
            (0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0, 160.0),
            "The direction in which each dome is brushed, row by row from the lower left.",
            "degrees",
        ),
        "k_s": word.SHARE(1.0, "The strength of the highlights.", word.FULL),
        "roughness": word.NUMBER(
            0.1, "The roughness of Schlick's model: 0 a mirror, 1 scatters evenly.", low=0.05, high=1.0
        ),
        "isotropy": word.NUMBER(
            0.4, "The isotropy of Schlick's model: 1 where no direction is another.", low=0.1, high=1.0
        ),
        "reflectance": word.SHARE(0.8, "What Schlick's model reflects at right angles.", word.FULL),
        "coefficients": word.of(
            word.Several((word.Number(-1.0, 1.0),) * 3),
            (-0.98, -0.3, 0.98),
            "The coefficients C_x, C_y, C_z of Lafortune's model.",
        ),
        "exponent": word.of(word.EXPONENT_KIND, 9.0, "The exponent of Lafortune's model."),
        "light": word.LIGHT((0.6, 0.5, 1.0)),
        "extent": word.EXTENT(0.92),
        "diffuse": word.DIFFUSE((0.26, 0.29, 0.34)),
        "ambient": word.AMBIENT((0.02, 0.025, 0.035)),
        "phong": word.SPECULAR((0.7, 0.68, 0.62), "The colour of the highlights by Phong's model."),
        "schlick": word.SPECULAR((0.7, 0.68, 0.62), "The colour of the highlights by Schlick's model."),
        "lafortune": word.SPECULAR((1.0, 0.97, 0.9), "The colour of the highlights by Lafortune's model."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method(BY_TEXTURE_SHADERS, texture_shaders_scene, ("GEFORCE_3", "NV2A", "FUTURE")),
        Method(BY_PIXEL_TEXTURES, pixel_textures_scene, ("OCTANE",)),
    ),
    acceptance=checks,
)
