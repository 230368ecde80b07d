"""H33: an environment of high dynamic range, made bytes before it is filtered and after."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments, prefilter, reflections
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import reflecting
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.user_pictures import probes
from fixedpipe.pipeline.enums import TexGenMode

DATA = figure_data(__file__, "H33")

PANELS = "Phong, of bytes", "Phong, of floats", "cosine, of bytes", "cosine, of floats"


def _source(size, edge, own=None):
    """The probe, scaled, its brightest still far above one: float64 [6, n, n, 3]."""
    edge = max(reflecting.texels(size, 256), 64) if edge is None else edge
    if own is None:
        probe = environments.faces(edge, environments.sunlit_room)
    else:
        probe = probes.maps(own, "cube", edge)
    return probe * prefilter.exposure(probe)


def scene(profile, size, *, eye, exponent, brightness, edge, probe):
    """H33: a lobe and a cosine of the probe as bytes hold it, and of the probe itself."""
    surface, probe = reflecting.ball_in_ring(size), _source(size, edge, probe)
    clamped = np.minimum(probe, 1.0)
    texels = probe.shape[1]
    cubes = (
        *(prefilter.phong(cube, exponent, texels // 2) for cube in (clamped, probe)),
        *(prefilter.cosine(cube, texels // 4) for cube in (clamped, probe)),
    )
    out = [reflections.load_cube(bumped_reflections.CUBE_MAP, clamped, profile)]
    for panel, name, cube in zip(row_of_panels(4, size), PANELS, cubes, strict=True):
        view = reflecting.camera(panel, eye)
        by = TexGenMode.NORMAL_MAP if name in PANELS[2:] else TexGenMode.REFLECTION_MAP
        out += (
            reflections.load_cube(name, np.minimum(brightness * cube, 1.0), profile),
            panel.clear(BACKGROUND),
            *bumped_reflections.backdrop(view),
            reflections.cube_pass(surface, view, name, by=by),
        )
    return tuple(out)


def _matt_checks(figure, renderer, size, surface, view, sun):
    """Where the light of the displayed cosine's panels comes from. ``sun``: the direction to it."""
    normals, _, known = reflecting.normals_by_rays(surface, view)
    facing = np.maximum(dot(normals, sun), 0.0)[known]
    for on in Answer:
        image = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        flat, lit = (panel_of(image, k)[known] for k in (2, 3))
        added = lit - flat
        for what, values in (("the third panel", flat), ("what floats add to it", added)):
            likeness = float(np.corrcoef(values.mean(axis=-1), facing)[0, 1])
            bound = {"at_most": 0.3} if values is flat else {"at_least": 0.95}
            yield DATA.check(
                "{what}: correlation with the cosine to the sun", likeness, on, what=what, **bound
            )
        yield DATA.check(
            "what floats add there: red over blue", float(added[:, 0].sum() / added[:, 2].sum()), on
        )


# How many pixels of a panel are compared with sums over all texels.
_SOME = 96


def _displayed_checks(figure, renderer):
    """Some pixels of what mirrors and is lit, and the room behind, by sums over the probe's texels."""
    size, values = figure.size, figure.values
    view = reflecting.camera(row_of_panels(4, size)[0], values["eye"])
    surface = reflecting.ball_in_ring(size)
    toward, known = reflecting.reflections_by_rays(surface, view)
    normals, (back, behind) = (
        reflecting.normals_by_rays(surface, view)[0],
        reflecting.backdrop_by_rays(surface, view),
    )
    probe = _source(size, 64)
    texels = cube_maps.directions(64).reshape(-1, 3)
    angles = np.broadcast_to(cube_maps.solid_angles(64), probe.shape[:3]).reshape(-1, 1)
    bytes_, floats = (
        np.concatenate([colors.reshape(-1, 3) * angles, angles], axis=-1)
        for colors in (np.minimum(probe, 1.0), probe)
    )
    some, places = reflecting.some_of(known, _SOME), reflecting.some_of(behind, 16 * _SOME)
    true = [
        np.minimum(
            values["brightness"] * reflecting.lobes(vectors.reshape(-1, 3)[some], texels, light, exponent),
            1.0,
        )
        for vectors, exponent in ((toward, values["exponent"]), (normals, 1.0))
        for light in (bytes_, floats)
    ]
    scale = prefilter.exposure(environments.faces(256, environments.sunlit_room))
    room = np.minimum(scale * environments.sunlit_room(back.reshape(-1, 3)[places]), 1.0)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        panels, shares = [panel_of(window, k).reshape(-1, 3) for k in range(4)], []
        for k, (panel, whole) in enumerate(zip(panels, true, strict=True)):
            flat, other = np.broadcast_to(whole.mean(axis=0), whole.shape), true[k ^ 1]
            shares.append(least_share(panel[some], whole, flat, other))
            shares.append(least_share(panel[places], room, np.broadcast_to(room.mean(axis=0), room.shape)))
        yield DATA.check(
            "of what maps, floats and the room behind change, the least share that is seen", min(shares), on
        )


# Not so bright that the lobe's peak is clamped.
_DIM = 1.0 / 32.0


def checks(figure, renderer):
    """The sun's image by sums over all texels, and what clamping the probe takes away."""
    yield from _displayed_checks(figure, renderer)
    size, edge = 128, 128
    view = reflecting.camera(row_of_panels(4, size)[0], figure.values["eye"])
    surface = reflecting.ball_in_ring(size)
    toward, known = reflecting.reflections_by_rays(surface, view)
    probe = _source(size, edge)
    texels = cube_maps.directions(edge).reshape(-1, 3)
    weights = np.broadcast_to(cube_maps.solid_angles(edge), probe.shape[:3]).reshape(-1)
    sun = texels[np.argmax(probe[..., 0])]
    yield from _matt_checks(figure, renderer, size, surface, view, sun)
    near = np.argmax(np.where(known, dot(toward, sun), -1.0))
    lobe = np.maximum(dot(texels, toward.reshape(-1, 3)[near]), 0.0) ** figure.values["exponent"] * weights
    true, cut = (
        _DIM * float((lobe * colors).sum() / lobe.sum())
        for colors in (probe[..., 0].reshape(-1), np.minimum(probe[..., 0], 1.0).reshape(-1))
    )
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = renderer.window(on, figure, size, brightness=_DIM, edge=edge)
        of_bytes, of_floats = (panel_of(image, k)[..., 0].reshape(-1)[near] for k in (0, 1))
        yield DATA.check(
            "the sun's image of floats against a sum over all texels, relative error",
            abs(float(of_floats) / true - 1.0),
            on,
        )
        yield DATA.check(
            "the sun's image of bytes against a sum over all clamped texels, error",
            abs(float(of_bytes) - cut),
            on,
        )
        yield DATA.check(
            "how many times as bright the sun's image is of floats", float(of_floats / of_bytes), on
        )
        matt = [panel_of(image, k)[known] for k in (2, 3)]
        yield DATA.check(
            "mean of the cosine's panels, of floats over of bytes", float(matt[1].mean() / matt[0].mean()), on
        )
        yield DATA.check(
            "where a filtered map of bytes is brighter, largest difference",
            float((panel_of(image, 0) - panel_of(image, 1))[known].max()),
            on,
            at_most={Answer.IDEAL: 1e-6, Answer.MACHINE: 1.0 / 255.0}[on],
        )


FIGURE = Figure(
    **DATA.words,
    panels=PANELS,
    parameters={
        "eye": word.POSITION((-1.35, 0.35, 2.55), "The eye."),
        "exponent": word.of(word.Number(1.0, 4096.0), 100.0, "The exponent of the lobe."),
        "brightness": word.of(
            word.Number(0.001, 64.0), 1.0, "What the filtered maps are multiplied by before they are bytes."
        ),
        "edge": word.FITTED_TEXELS(None, "The edge of the probe's faces."),
        "probe": own_maps.PROBE,
    },
    methods=(Method("cube maps", scene, COMBINER_MACHINES),),
    acceptance=checks,
)
