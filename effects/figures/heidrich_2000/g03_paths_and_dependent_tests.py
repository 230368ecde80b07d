"""G03, G04, G05: random paths, several directions at every place, and dependent tests.

A point between texels takes the indirect light of the nearest texel, or of four.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared.relief import lit_relief, oblique_view
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.surfaces import plane
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.passes.draws import NEAREST, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import height_field, light_transport, path_tracer
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.path_tracer import Reconstruction
from fixedpipe.effects.scattering.visibility import free_view, precompute
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "G03")

NAMES = ("random paths", "several directions", "dependent tests")
EYE = (0.0, -2.7, 2.7)
UP = (0.0, 0.0, 1.0)
# A magnified part: its lower left corner as a share of the field, its edge in texels, points a texel.
_CORNER, _PART, _POINTS = (0.47, 0.47), 8, 16
_PART_TEXELS = 32


@lru_cache(maxsize=8)
def _domes(texels, count, height, albedo, directions):
    """Domes whose rims are smoothed: an upright rim has no texels of its own."""
    heights = height_field.domes(texels, texels, count, height=height).heights
    field = height_field.height_field(height_fields.smooth(heights, texels // 32), albedo)
    return field, precompute(field, spiral(directions))


def edge_of(size, texels):
    """The field's edge in texels: half a panel's at most, so that small pictures are cheap."""
    return min(texels, 1 << max(2, (size // 2).bit_length() - 1))


def _lookups_alike(paths, lookups):
    """How many directions at every place make about as many lookups as paths with one."""
    branches = 1
    while sum((branches + 1) ** k for k in range(1, lookups + 1)) <= paths * lookups:
        branches += 1
    return branches


@lru_cache(maxsize=8)
def lights(edge, domes, height, albedo, directions, paths, lookups, light):
    """Each method's light of every texel, and what all directions give: four float64 [edge, edge, 3]."""
    field, visibility = _domes(edge, domes, height, albedo, directions)
    towards = height_field.check_light(light)
    lit = free_view(field, towards)
    s, t = (place.ravel() for place in height_fields.texel_centers(edge, edge))
    gathered = light_transport.bounces(field, visibility, towards, lookups, lit=lit)
    branches = _lookups_alike(paths, lookups)
    out = []
    for samples, at_once in ((paths, 1), (1, branches)):
        found = path_tracer.indirect(
            field,
            visibility,
            s,
            t,
            towards,
            samples=samples,
            branches=at_once,
            lookups=lookups,
            lit=lit,
            reconstruction=Reconstruction.NEAREST,
        )
        out.append(gathered[0] + found.reshape(edge, edge, 3))
    # So many of all directions, from the zenith to the horizon and below it.
    every = light_transport.sequences(directions, lookups, max(paths, directions))
    numbers = every[np.arange(paths) * len(every) // paths]
    out.append(light_transport.scattered(field, visibility, numbers, towards, lit=lit))
    return (*out, gathered[-1])


@lru_cache(maxsize=8)
def magnified(points, domes, height, albedo, directions, samples, light):
    """Indirect light of a small part, of the nearest texel and between four: two float64 [points, points,
    3].
    """
    field, visibility = _domes(_PART_TEXELS, domes, height, albedo, directions)
    towards = height_field.check_light(light)
    place = (np.arange(points) + 0.5) / points * _PART / _PART_TEXELS
    s, t = (p.ravel() for p in np.meshgrid(*(_texel_edge(c) + place for c in _CORNER)))
    out = []
    for how in (Reconstruction.NEAREST, Reconstruction.BILINEAR):
        found = path_tracer.indirect(
            field, visibility, s, t, towards, samples=samples, lookups=1, reconstruction=how
        )
        out.append(found.reshape(points, points, 3))
    return tuple(out)


def _texel_edge(share):
    return int(share * _PART_TEXELS) / _PART_TEXELS


def scene(
    profile, size, *, texels, domes, height, albedo, directions, paths, lookups, samples, light, brighter
):
    """Three reliefs, each with the light of a method, and twice the magnified part's indirect light."""
    edge = edge_of(size, texels)
    common = (domes, height, tuple(albedo), directions)
    field, _ = _domes(edge, *common)
    surface, panels = relief(field), row_of_panels(5, size)
    out = [panel.clear(BACKGROUND) for panel in panels]
    pictures = lights(edge, *common, paths, lookups, tuple(light))[:3]
    for name, picture, panel in zip(NAMES, pictures, panels[:3], strict=True):
        image = texture_2d(factor_texels(np.minimum(picture, 1.0), profile))
        out.append(TexImage(label=f"load the light by {name}", texture=name, image=image))
        out.append(lit_relief(f"the domes, {name}", surface, oblique_view(panel, EYE), name))
    points = min(_PART * _POINTS, 1 << (size.bit_length() - 1))
    parts = magnified(points, *common, samples, tuple(light))
    for how, picture, panel in zip(Reconstruction, parts, panels[3:], strict=True):
        image = texture_2d(factor_texels(np.minimum(brighter * picture, 1.0), profile))
        out.append(TexImage(label=f"load {how.value} indirect light", texture=how.value, image=image))
        out.append(
            draw(
                f"indirect light, {how.value}",
                plane().mesh(),
                drawing.sheet(panel),
                None,
                (unit(how.value, NEAREST, environment=REPLACE),),
                depth_test=None,
            )
        )
    return tuple(out)


# ---------------------------------------------------------------------------------------------- checks


def _roughness(picture):
    """RMS of the differences of texels from their right and upper neighbours."""
    across, up = picture - np.roll(picture, 1, 1), picture - np.roll(picture, 1, 0)
    return float(np.sqrt(0.5 * ((across * across).mean() + (up * up).mean())))


def _steps(panel):
    """Mean squares of a picture's steps along rows and columns, at texels' borders and elsewhere."""
    size = len(panel)
    texel = np.floor((np.arange(size) + 0.5) / size * _PART)
    border = texel[1:] != texel[:-1]
    # Along lines as wide as a texel, in which most of the paths' noise averages out.
    lines = [picture.reshape(_PART, -1, size, 3).mean(axis=1) for picture in (panel, panel.swapaxes(0, 1))]
    energy = sum((np.diff(line, axis=1) ** 2).mean(axis=(0, 2)) for line in lines)
    return float(energy[border].mean()), float(energy[~border].mean())


def _true_panels(size, v):
    """Of each panel which pixels are compared, bool [size, size], and their colours, [n, 3]."""
    edge, shared = edge_of(size, v["texels"]), (v["domes"], v["height"], tuple(v["albedo"]), v["directions"])
    field, _ = _domes(edge, *shared)
    seen = seen_places.surface(relief(field), oblique_view(Panel(0, 0, size, size), EYE))
    for light in lights(edge, *shared, v["paths"], v["lookups"], tuple(v["light"]))[:3]:
        yield seen.where, seen_places.looked_up(light, seen)
    points = min(_PART * _POINTS, 1 << (size.bit_length() - 1))
    for part in magnified(points, *shared, v["samples"], tuple(v["light"])):
        whole = np.ones((size, size), np.bool_)
        yield whole, seen_places.still(v["brighter"] * part, size)[whole]


def _checks_by_pixels(figure, renderer):
    """What each panel shows at every pixel."""
    true = list(_true_panels(figure.size, figure.values))
    for on, share in seen_places.shares_alike(figure, renderer, dict(enumerate(true))):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )


def checks(figure, renderer):
    """What panels show by pixels; means against all directions, noise between neighbours, blocks."""
    yield from _checks_by_pixels(figure, renderer)
    v = figure.values
    shared = (v["domes"], v["height"], tuple(v["albedo"]), v["directions"])
    random, several, dependent, all_of = lights(
        v["texels"], *shared, v["paths"], v["lookups"], tuple(v["light"])
    )
    for name, picture in zip(NAMES[:2], (random, several), strict=True):
        error = (picture - all_of)[..., 1]
        yield DATA.check(
            "mean light by {name} less what all directions give, in standard errors: absolute",
            float(abs(error.mean()) / (error.std() / np.sqrt(error.size))),
            Answer.IDEAL,
            name=name,
        )
    rough = [_roughness(picture - all_of) for picture in (random, several, dependent)]
    for name, value in zip(NAMES[:2], rough, strict=False):
        yield DATA.check(
            "errors' differences between neighbours, {name} over dependent tests",
            value / rough[2],
            Answer.IDEAL,
            name=name,
        )
    errors = [float(np.sqrt(((p - all_of) ** 2).mean())) for p in (random, dependent)]
    yield DATA.check(
        "RMS error of dependent tests over that of as many random paths", errors[1] / errors[0], Answer.IDEAL
    )
    size = _PART * _POINTS
    for on in Answer:
        window = renderer.window(on, figure, size)
        blocks, smooth = (_steps(panel_of(window, k)) for k in (3, 4))
        yield DATA.check(
            "energy of steps at texels' borders, nearest over bilinear", blocks[0] / smooth[0], on
        )
        yield DATA.check(
            "energy of steps at texels' borders over that of others, bilinear", smooth[0] / smooth[1], on
        )
    yield arithmetic_check(figure, renderer, 0.004, "what the host computed is stored in bytes")


FIGURE = Figure(
    **DATA.words,
    panels=(*NAMES, "nearest texel", "between four"),
    size=400,
    parameters={
        "texels": word.of(word.Whole(4, 128, power=True), 128, "The height field's edge, at most.", "texels"),
        "domes": word.of(word.Whole(1, 8), 3, "Domes along an edge."),
        "height": word.NUMBER(0.8, "The domes' height, over half balls'.", low=0.0, high=2.0),
        "albedo": word.COLOR((0.9, 0.75, 0.55), "The share of light that the surface scatters."),
        "directions": word.of(word.Whole(4, 400), 100, "Directions over the sphere."),
        "paths": word.of(word.Whole(1, 400), 20, "Paths from each texel."),
        "lookups": word.of(word.Whole(1, 4), 2, "Lookups along a path."),
        "samples": word.of(word.Whole(1, 4096), 400, "Paths from each point of the magnified part."),
        "light": word.LIGHT((-0.85, 0.31, 0.62)),
        "brighter": word.NUMBER(4.0, "By what indirect light alone is multiplied.", low=1.0, high=32.0),
    },
    methods=(Method("computed by the host, shown as textures", scene, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
)
