"""G22: domes with shadows and scattered light as geometry, and the same light as a bump map on a plane."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.relief import lit_relief, oblique_view
from fixedpipe.effects.figures.heidrich_2000.shared.texture_space import smooth_domes
from fixedpipe.effects.figures.scattering_ways import largest_power
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import light_transport, visibility
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G22")

EYE = (0.0, -4.3, 2.25)
# Samples along a pixel's edge of the software renderer.
_SAMPLES = 3
_NAME = "light of the domes"


@lru_cache(maxsize=8)
def _light(texels, domes, height, albedo, directions, bounces, light):
    """The field, and what its texels send: float64 [rows, columns, 3]."""
    field = smooth_domes(texels, domes, height, albedo)
    seen = visibility.precompute(field, spiral(directions))
    return field, light_transport.bounces(field, seen, check_light(light), bounces)[-1]


def _surfaces(field):
    """The field as geometry, and the plane of its mean height, with the same texels at the same places."""
    mean = replace(field, heights=np.full(field.heights.shape, float(field.heights.mean())))
    return relief(field, level_border=True), relief(mean)


def _made(size, texels, exposure, *, domes, height, albedo, directions, bounces, light):
    """The two surfaces and their texture of light, smaller on small pictures."""
    made_of = domes, height, tuple(albedo), directions, bounces, tuple(light)
    field, light = _light(largest_power(size // 2, texels), *made_of)
    return _surfaces(field), exposure * light


def scene(profile, size, *, texels, exposure, **of_domes):
    """The host computes the light of the texels; the machine draws it on the geometry and on the plane."""
    surfaces, values = _made(size, texels, exposure, **of_domes)
    texels = factor_texels(values if profile.arithmetic.exact else np.minimum(values, 1.0), profile)
    out = [TexImage(label=f"load the {_NAME}", texture=_NAME, image=texture_2d(texels))]
    for what, panel, surface in zip(
        ("the domes' triangles", "the plane"), row_of_panels(2, size), surfaces, strict=True
    ):
        out += [panel.clear(BACKGROUND), lit_relief(what, surface, oblique_view(panel, EYE), _NAME)]
    return tuple(out)


def _looked_up(table, at):
    """Bilinear in a table that repeats, at texture coordinates [n, 2]: float64 [n, 3]."""
    rows, columns = table.shape[:2]
    x, y = at[:, 0] * columns - 0.5, at[:, 1] * rows - 0.5
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    f, g = (x - i)[:, None], (y - j)[:, None]
    i, j, right, above = i % columns, j % rows, (i + 1) % columns, (j + 1) % rows
    low = table[j, i] * (1.0 - f) + table[j, right] * f
    high = table[above, i] * (1.0 - f) + table[above, right] * f
    return low * (1.0 - g) + high * g


def _seen_by_rays(surface, values, edge):
    """What rays through the pixels' centres see of a surface: RGB [edge, edge, 3], bottom row first, and
    where they meet it.
    """
    hits = RayCaster(surface.positions[surface.triangles]).nearest(
        *primary_rays(oblique_view(Panel(0, 0, edge, edge), EYE)), 1.0
    )
    found = hits.triangle >= 0
    out = np.tile(np.array(BACKGROUND), (edge * edge, 1))
    corners = surface.texture_coordinates[surface.triangles[hits.triangle[found]]]
    at = (corners * hits.barycentrics[found][..., None]).sum(axis=1)
    out[found] = np.minimum(_looked_up(values, at), 1.0)
    return out.reshape(edge, edge, 3), found.reshape(edge, edge)


def by_rays(size, *, texels, exposure, **of_domes):
    """The same by rays, nine a pixel, at the field's triangles: RGBA, top row first."""
    surfaces, values = _made(size, texels, exposure, **of_domes)
    out = np.ones((size, 2 * size, 4))
    for number, surface in enumerate(surfaces):
        fine, _ = _seen_by_rays(surface, values, _SAMPLES * size)
        mean = fine.reshape(size, _SAMPLES, size, _SAMPLES, 3).mean(axis=(1, 3))
        out[:, number * size : (number + 1) * size, :3] = mean[::-1]
    return out


def _shadows_apart(values):
    """The share of texels at which rays among the triangles, 3 x 3 periods of them, and S_i disagree of the
    light: those whose normal faces it.
    """
    field, _ = _light(32, **values)
    surface, light = relief(field), check_light(values["light"])
    corners = surface.positions[surface.triangles]
    moved = [corners + np.array((2.0 * x, 2.0 * y, 0.0)) for x in (-1, 0, 1) for y in (-1, 0, 1)]
    columns, rows = field.columns, field.rows
    points = surface.positions.reshape(rows + 1, columns + 1, 3)[:rows, :columns].reshape(-1, 3)
    facing = (dot(field.normals, light) > 0.0).ravel()
    # A ray begins at a vertex; a little above it, no triangle of its own is in its way by rounding.
    start = points[facing] + np.array((0.0, 0.0, 1e-9))
    hidden = RayCaster(np.concatenate(moved)).occluded(
        start, np.broadcast_to(light, start.shape), longest=4.0
    )
    return float((hidden == visibility.free_view(field, light).ravel()[facing]).mean())


def checks(figure, renderer):
    """Both panels against rays, what geometry hides and where it stands out, and the scattered light."""
    size = 128
    values = {name: value for name, value in figure.values.items() if name not in ("texels", "exposure")}
    yield DATA.check(
        "share of texels where rays among the triangles and S_i disagree of shadow",
        _shadows_apart(values),
        Answer.IDEAL,
    )
    surfaces, light = _made(size, figure.values["texels"], figure.values["exposure"], **values)
    rays = [_seen_by_rays(surface, light, size) for surface in surfaces]
    background = np.array(BACKGROUND)
    for on in Answer:
        window = renderer.window(on, figure, size)
        panels = [panel_of(window, number) for number in range(2)]
        covered = [np.abs(panel - background).max(axis=-1) > 1.0 / 255.0 for panel in panels]
        for what, panel, (seen, _) in zip(("geometry", "bump map"), panels, rays, strict=True):
            apart = np.abs(np.clip(panel, 0.0, 1.0) - seen).max(axis=-1)
            yield DATA.check(
                "{what}: share of pixels more than 0.05 from rays",
                float((apart > 0.05).mean()),
                on,
                what=what,
            )
        beyond = float((covered[0] & ~covered[1]).sum() / covered[1].sum())
        truth = float((rays[0][1] & ~rays[1][1]).sum() / rays[1][1].sum())
        yield DATA.check(
            "outline: pixels of the geometry outside the plane's, of the plane's", beyond, on, truth=truth
        )
        inner = covered[0] & covered[1]
        yield DATA.check(
            "masking: share of common pixels that differ by more than 0.1",
            float((np.abs(panels[0] - panels[1]).max(axis=-1) > 0.1)[inner].mean()),
            on,
        )
        without = renderer.window(on, figure, size, bounces=0)
        for number, what in enumerate(("geometry", "bump map")):
            yield DATA.check(
                "{what}: mean with scattering over the mean without",
                float(panels[number].mean() / panel_of(without, number).mean()),
                on,
                what=what,
            )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.of(word.Whole(16, 256, power=True), 256, "The field's edge, at most.", "texels"),
        "domes": word.of(word.Whole(1, 8), 4, "Domes along an edge."),
        "height": word.NUMBER(0.9, "The domes' height, over half balls'.", low=0.1, high=2.0),
        "albedo": word.COLOR((0.86, 0.62, 0.42), "The share of light that the surface scatters."),
        "directions": word.of(word.Whole(4, 400), 100, "Directions along which light is gathered."),
        "bounces": word.of(word.Whole(0, 8), 3, "Reflections beyond the first."),
        "light": word.LIGHT((-0.78, 0.31, 0.85)),
        "exposure": word.NUMBER(1.15, "What all light is multiplied by.", low=0.1, high=2.0),
    },
    methods=(Method("textures of scattered light", scene, ("GEFORCE_256", "OPENGL_1_2", "OCTANE")),),
    acceptance=checks,
    reference=by_rays,
)
