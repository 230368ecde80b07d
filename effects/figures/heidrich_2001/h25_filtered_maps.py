"""H25: an environment map unfiltered, filtered by two of Phong's lobes (H29), and by a cosine."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments, prefilter, reflections
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import reflecting
from fixedpipe.effects.geometry import cube_maps, parabolic_maps
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.pipeline.enums import TexGenMode

DATA = figure_data(__file__, "H25")

PLAIN_MACHINES = ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY", "G400")
NAMES = "mirror", "narrow lobe", "wide lobe", "cosine"
# Where the point is.
_TOWARD_POINT = (0.3, 0.5, 1.0)


def _point(toward):
    """A spot 2 degrees wide, whose image by an exponent of 100 is 0.9 bright in the middle."""
    near = dot(normalize(toward), normalize(np.array(_TOWARD_POINT))) > 0.99985
    share = 101.0 / 2.0 * (1.0 - 0.99985)
    return np.where(near[..., None], np.full(3, 0.9 / share), 0.0)


def _white(toward):
    return np.full((*np.shape(toward)[:-1], 3), 0.5)


_ENVIRONMENTS = {"room": environments.room, "white": _white, "point": _point}


def maps(size, environment, edge, photograph, exponents):
    """The four cube maps of floats, as NAMES has them."""
    room = photograph.panorama if photograph else _ENVIRONMENTS[environment]
    edge = reflecting.texels(size, 256) if edge is None else edge
    faces = environments.faces(edge, room)
    filtered = [prefilter.phong(faces, exponent, max(edge // 2, 8)) for exponent in exponents]
    return faces, *filtered, prefilter.cosine(faces, max(edge // 4, 8))


def cube_scene(profile, size, *, eye, environment, edge, photograph, narrow, wide):
    """H25 and H29 by cube maps: three looked up by the reflected vector, the last by the normal."""
    surface, out = reflecting.ball_in_ring(size), []
    every = maps(size, environment, edge, photograph, (narrow, wide))
    for panel, name, cube in zip(row_of_panels(4, size), NAMES, every, strict=True):
        view = reflecting.camera(panel, eye)
        if name == NAMES[0]:
            out.append(reflections.load_cube(bumped_reflections.CUBE_MAP, np.clip(cube, 0.0, 1.0), profile))
        out.append(reflections.load_cube(name, np.clip(cube, 0.0, 1.0), profile))
        by = TexGenMode.NORMAL_MAP if name == NAMES[3] else TexGenMode.REFLECTION_MAP
        out += (
            panel.clear(BACKGROUND),
            *bumped_reflections.backdrop(view),
            reflections.cube_pass(surface, view, name, by=by),
        )
    return tuple(out)


def discs_scene(profile, size, *, eye, environment, edge, photograph, narrow, wide):
    """H25 and H29 by parabolic maps and the host's vectors, with one unit."""
    surface, out = reflecting.ball_in_ring(size), []
    every = maps(size, environment, edge, photograph, (narrow, wide))
    texels = reflecting.texels(size)
    toward = parabolic_maps.directions(texels, parabolic_maps.margin(texels))
    room = photograph.panorama if photograph else _ENVIRONMENTS[environment]
    for panel, name, cube in zip(row_of_panels(4, size), NAMES, every, strict=True):
        view = reflecting.camera(panel, eye)
        load, backdrop = bumped_reflections.picture_backdrop(
            view, texels, profile, lambda v: np.clip(room(v), 0.0, 1.0)
        )
        names = f"{name}, first disc", f"{name}, second disc"
        discs = np.clip(cube_maps.look_up(cube, toward), 0.0, 1.0)
        vectors = surface.normals if name == NAMES[3] else None
        out += (
            *((load,) if name == NAMES[0] else ()),
            *reflections.load_discs(names, discs, profile),
            panel.clear(BACKGROUND),
            backdrop,
            *reflections.parabolic_passes(surface, view, names, texels, vectors),
        )
    return tuple(out)


def _sums(cube, exponent, toward):
    """The filter for directions [n, 3] by a sum over all texels of a cube map as it is."""
    size = cube.shape[1]
    texels = cube_maps.directions(size).reshape(-1, 3)
    weights = np.broadcast_to(cube_maps.solid_angles(size), (6, size, size)).reshape(-1, 1)
    lobes = np.maximum(dot(texels[:, None], toward[None]), 0.0) ** exponent * weights
    return lobes.T @ cube.reshape(-1, 3) / lobes.sum(axis=0)[:, None]


# How many pixels of a panel are compared with sums over all texels.
_SOME = 96


@lru_cache(maxsize=1)
def _by_rays(size, eye, narrow, wide):
    """Some pixels of what mirrors, by their numbers, and what each panel shows there: a list of float64
    [n, 3]. Some of the room behind, and its colours. By the room itself and sums over its texels.
    """
    view, surface = reflecting.camera(row_of_panels(4, size)[0], eye), reflecting.ball_in_ring(size)
    toward, known = reflecting.reflections_by_rays(surface, view)
    normals, _, _ = reflecting.normals_by_rays(surface, view)
    back, behind = reflecting.backdrop_by_rays(surface, view)
    some, places = reflecting.some_of(known, _SOME), reflecting.some_of(behind, 16 * _SOME)
    texels = cube_maps.directions(64).reshape(-1, 3)
    angles = np.broadcast_to(cube_maps.solid_angles(64), (6, 64, 64)).reshape(-1, 1)
    light = np.concatenate([environments.room(texels) * angles, angles], axis=-1)
    toward, normals = (vectors.reshape(-1, 3)[some] for vectors in (toward, normals))
    lobes = ((toward, narrow), (toward, wide), (normals, 1.0))
    true = [environments.room(toward), *(reflecting.lobes(v, texels, light, n) for v, n in lobes)]
    return some, true, places, environments.room(back.reshape(-1, 3)[places])


def _displayed_checks(figure, renderer):
    """What mirrors, and the room behind, as displayed."""
    values = figure.values
    some, true, places, room = _by_rays(figure.size, *(values[name] for name in ("eye", "narrow", "wide")))
    flat_room = np.broadcast_to(room.mean(axis=0), room.shape)
    for on in (Answer.MACHINE, Answer.IDEAL):
        window, shares = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0), []
        for k, whole in enumerate(true):
            panel = panel_of(window, k).reshape(-1, 3)
            flat = np.broadcast_to(whole.mean(axis=0), whole.shape)
            beside = [true[n] for n in (k - 1, k + 1) if 0 <= n < len(true)]
            shares.append(least_share(panel[some], whole, flat, *beside))
            shares.append(least_share(panel[places], room, flat_room))
        yield DATA.check(
            "of what maps, filters and the room behind change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """Panels against sums over all texels where rays meet the objects; a constant map; a point's image."""
    yield from _displayed_checks(figure, renderer)
    size, values = 128, figure.values
    panel = row_of_panels(4, size)[0]
    surface, view = reflecting.ball_in_ring(size), reflecting.camera(panel, values["eye"])
    normals, _, _ = reflecting.normals_by_rays(surface, view)
    toward, known = reflecting.reflections_by_rays(surface, view)
    some = np.flatnonzero(known)[:: max(1, int(known.sum()) // 150)]
    faces = environments.faces(64)
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = renderer.window(on, figure, size, edge=64)
        for number, exponent, vectors in (
            (1, values["narrow"], toward),
            (2, values["wide"], toward),
            (3, 1.0, normals),
        ):
            true = _sums(faces, exponent, vectors.reshape(-1, 3)[some])
            error = panel_of(image, number).reshape(-1, 3)[some] - true
            yield DATA.check(
                "{which} against sums over all texels where rays meet, RMS",
                root_mean_square(error),
                on,
                which=NAMES[number],
            )
        white = renderer.window(on, figure, size, environment="white", edge=64)
        yield DATA.check(
            "largest change of a constant map by the filters",
            max(
                float(np.abs(panel_of(white, number)[known] - panel_of(white, 0)[known]).max())
                for number in (1, 2, 3)
            ),
            on,
            at_most={Answer.IDEAL: 1e-9, Answer.MACHINE: 1.0 / 255.0}[on],
        )
    yield _width(figure, renderer)
    room = renderer.window(Answer.MACHINE, figure, size)
    yield DATA.check(
        "differences of neighbouring pixels in the wide lobe over those in the mirror",
        _roughness(panel_of(room, 2), known) / _roughness(panel_of(room, 0), known),
        Answer.MACHINE,
    )


def _roughness(image, known):
    """The mean difference of pixels from those to their left, where all are known."""
    return float(np.abs(image[:, 1:] - image[:, :-1])[known[:, 1:] & known[:, :-1]].mean())


def _width(figure, renderer):
    """The half width of a point's image by the narrow lobe."""
    size = 256
    view = reflecting.camera(row_of_panels(4, size)[0], figure.values["eye"])
    toward, known = reflecting.reflections_by_rays(reflecting.ball_in_ring(size), view)
    point = panel_of(renderer.window(Answer.IDEAL, figure, size, environment="point", edge=256), 1)[..., 0]
    lit = known & (point > 0.2) & (point < 0.95)
    # The slope of log brightness over the log of the cosine is the exponent.
    cosines = np.log(dot(toward[lit], normalize(np.array(_TOWARD_POINT))))
    exponent = np.polyfit(cosines, np.log(point[lit]), 1)[0]
    return DATA.check(
        "how far the half width of a point's image is from 6.74 degrees",
        abs(float(np.degrees(np.arccos(0.5 ** (1.0 / exponent)))) - 6.74),
        Answer.IDEAL,
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "eye": word.POSITION((0.0, 0.35, 2.9), "The eye."),
        "environment": word.of(
            word.Choice({name: name for name in _ENVIRONMENTS}),
            "room",
            "What is around: a room, grey, or one bright spot.",
        ),
        "narrow": word.of(word.Number(1.0, 4096.0), 100.0, "The exponent of the second panel's lobe."),
        "wide": word.of(word.Number(1.0, 4096.0), 10.0, "The exponent of the third panel's lobe."),
        "edge": word.FITTED_TEXELS(None, "The edge of the cube map's faces before it is filtered."),
        "photograph": own_maps.PANORAMA,
    },
    methods=(
        Method("cube maps", cube_scene, COMBINER_MACHINES),
        Method("parabolic maps and the host's vectors", discs_scene, PLAIN_MACHINES),
    ),
    acceptance=checks,
)
