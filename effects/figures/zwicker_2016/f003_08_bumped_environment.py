"""F003-8: a bumpy sphere in which a room is reflected."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import arithmetic_check, root_mean_square
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import (
    angles,
    map_normals,
    own_normals,
    slices,
    texels,
)
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, from_frame, normalize
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, perspective_view, row_of_panels

DATA = figure_data(__file__, "F003-8")

REPEATS = (2, 1)
LEAN = 28.0
EYE, FIELD_OF_VIEW = (0.0, 0.3, 2.7), 50.0


def directions(toward):
    """An environment whose colours are the directions themselves, (d + 1)/2 of length one."""
    return 0.5 * normalize(toward) + 0.5


ENVIRONMENTS = {"room": environments.room, "directions": directions}


def bumps(edge, relief):
    """Waves on a map ``edge`` texels wide: normals in tangent space, float64 [edge, edge, 3]."""
    s, t = height_fields.texel_centers(edge, edge)
    return map_normals(relief * height_fields.turbulence(s, t, 5, 2, 21))


def the_sphere(size):
    """The figure's sphere on a panel of ``size`` pixels; the seam is behind. It leans, so that neither its
    tangents nor its binormals lie along the panel's edges.
    """
    n = slices(size)
    return surfaces.sphere(n, n // 2).with_repeats(*REPEATS).rotated(rotation("z", LEAN))


def _maps(size, relief, maps, height_field, height_scale):
    edge = texels(size) if maps is None else maps
    flat = np.zeros((1, 1, 3)) + np.array([0.0, 0.0, 1.0])
    if height_field is None:
        waves = bumps(edge, relief)
    else:
        waves = own_normals(height_field, edge, edge, height_scale)
    return (("mirror", flat), ("waves", waves))


def cube_scene(profile, size, *, tint, environment, cube, photograph, **waves):
    """F003-8 by texture shaders: a mirror, and a mirror with waves.

    ``waves``: of ``_maps``. ``cube``: the edge of the cube map's faces; None: fit for the panel.
    """
    surface = the_sphere(size)
    cube = 2 * texels(size) if cube is None else cube
    room = photograph.panorama if photograph else ENVIRONMENTS[environment]
    out = [bumped_reflections.load_environment(cube, profile, room)]
    for panel, (name, normals) in zip(row_of_panels(2, size), _maps(size, **waves), strict=True):
        view = perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW, radius=1.1)
        loading, names = bumped_reflections.load(normals, 1.0, name, profile)
        out += (
            loading[0],
            panel.clear(BACKGROUND),
            *bumped_reflections.backdrop(view),
            *bumped_reflections.reflection_pass(surface, names, view, dirt=False, tint=tint),
        )
    return tuple(out)


def offset_scene(profile, size, *, tint, environment, cube, photograph, **waves):
    """F003-8 by offsets of a sphere map, whose edge is twice ``cube``; ``tint`` is not used."""
    surface = the_sphere(size)
    room = photograph.panorama if photograph else ENVIRONMENTS[environment]
    across, along = (8, 6) if size < 64 else (16, 12)
    edge = 2 * texels(size) if cube is None else cube
    out = []
    for panel, (name, normals) in zip(row_of_panels(2, size), _maps(size, **waves), strict=True):
        view = perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW, radius=1.1)
        loading, names = bumped_reflections.load_offsets(normals, 1.0, name, profile)
        load, show = bumped_reflections.picture_backdrop(view, edge, profile, room)
        if not out:
            out += (bumped_reflections.load_sphere_map(2 * edge, view, profile, room), load)
        out += (
            loading[0],
            panel.clear(BACKGROUND),
            show,
            *bumped_reflections.offset_passes(surface, names, view, across=across, along=along),
        )
    return tuple(out)


def reference(surface, view, normals, size):
    """(reflected directions, n.e, covered) at the pixels of a panel: rays cast at the surface's triangles,
    frames interpolated there, and the normal map filtered. No result of the machine is used.
    """
    caster = RayCaster(surface.positions[surface.triangles])
    origins, along = primary_rays(view)
    hits = caster.nearest(origins, along, 1.0)
    seen = hits.triangle >= 0
    corners = surface.triangles[hits.triangle[seen]]

    def at(values):
        return (values[corners] * hits.barycentrics[seen][..., None]).sum(axis=1)

    frame = (at(surface.tangents), at(surface.binormals), at(surface.normals))
    coordinates = at(surface.texture_coordinates)
    normal = normalize(from_frame(_filtered(normals, coordinates), *frame))
    eye = normalize(-along[seen])
    out, facing = np.zeros((size * size, 3)), np.zeros(size * size)
    out[seen], facing[seen] = reflected(eye, normal), dot(eye, frame[2])
    return out.reshape(size, size, 3), facing.reshape(size, size), seen.reshape(size, size)


def _filtered(image, coordinates):
    """A repeated image [rows, columns, 3] between its texel centres."""
    rows, columns = image.shape[:2]
    x, y = coordinates[:, 0] * columns - 0.5, coordinates[:, 1] * rows - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    f, g = (x - i)[:, None], (y - j)[:, None]
    low, high = (
        image[(j + k) % rows, i % columns] * (1.0 - f) + image[(j + k) % rows, (i + 1) % columns] * f
        for k in (0, 1)
    )
    return low * (1.0 - g) + high * g


@lru_cache(1)
def _by_rays(size, relief):
    """Which pixels show a sphere, the room behind, and what the mirror and the waves mirror: RGB [n, 3]."""
    view = perspective_view(row_of_panels(1, size)[0], EYE, field_of_view=FIELD_OF_VIEW, radius=1.1)
    mirrored = []
    for _, normals in _maps(size, relief, None, None, 1.0):
        toward, _, seen = reference(the_sphere(size), view, normals, size)
        mirrored.append(environments.room(toward[seen]))
    behind = environments.room(primary_rays(view)[1]).reshape(size, size, 3)
    return seen, behind[~seen], mirrored


def _displayed_checks(figure, renderer):
    """What the displayed spheres mirror, and the wall behind them, against rays into the room."""
    size = figure.size
    seen, wall, mirrored = _by_rays(size, figure.values["relief"])
    for on in Answer:
        panels = [panel_of(np.clip(renderer.window(on, figure, size), 0.0, 1.0), k) for k in (0, 1)]
        shares = []
        for number, (shown, true) in enumerate(zip(panels, mirrored, strict=True)):
            shares.append(least_share(shown[~seen], wall, wall.mean(axis=0)))
            if not number:
                shares.append(least_share(shown[seen], true, true.mean(axis=0)))
            elif renderer.method.name == "texture shaders":  # the offsets of a sphere map are secants
                shares.append(least_share(shown[seen], true, true.mean(axis=0), mirrored[0]))
        yield DATA.check(
            "of what the room and the waves change, the least share that is seen", min(shares), on
        )


# Of each method, for the ideal and for the machine: how far reflected directions may be from the reference's,
# RMS degrees, and why.
_ERRORS = {
    "texture shaders": (
        (0.24, "vertices lie on sixteenths of a pixel, and waves turn by ten degrees in one"),
        (1.0, "the catalogue's: 8-bit normals"),
    ),
    "offsets of a sphere map": (
        (3.4, "one matrix for each part, and its coordinates taken as linear in the bumps; a third of slack"),
        (3.5, "the same, and offsets of 8 bits; a third of slack"),
    ),
}


def checks(figure, renderer):
    """The direction that a picture of directions shows against the reflection in the bumped normal."""
    size, maps = 128, 128
    relief = figure.values["relief"]
    view = perspective_view(row_of_panels(2, size)[1], EYE, field_of_view=FIELD_OF_VIEW, radius=1.1)
    surface = the_sphere(size)
    true, facing, seen = reference(surface, view, bumps(maps, relief), size)
    flat, _, _ = reference(surface, view, np.zeros((1, 1, 3)) + np.array([0.0, 0.0, 1.0]), size)
    inside = seen & (facing > 0.35)
    changes = {"environment": "directions", "maps": maps, "cube": 128, "tint": (1.0, 1.0, 1.0)}
    for on, (bound, reason) in zip(
        (Answer.IDEAL, Answer.MACHINE), _ERRORS[renderer.method.name], strict=True
    ):
        shown = panel_of(renderer.window(on, figure, size, **changes), 1)[inside]
        error = root_mean_square(angles(normalize(2.0 * shown - 1.0), true[inside]))
        name = "reflected direction against a ray cast at the mesh, RMS degrees"
        yield Check(name, error, at_most=bound, on=on, reason=reason)
    yield DATA.check(
        "how far the waves turn reflections, RMS degrees",
        root_mean_square(angles(flat[inside], true[inside])),
        Answer.IDEAL,
    )
    yield arithmetic_check(
        figure,
        renderer,
        0.03,
        "8-bit normals turn reflections by half a degree, seen at window bars; a quarter of slack",
    )
    yield from _displayed_checks(figure, renderer)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(0.035, low=0.0, high=1.0),
        "tint": word.COLOR(
            (1.0, 1.0, 1.0), "What the reflection is multiplied by, where texture shaders draw it."
        ),
        "environment": word.of(
            word.Choice({name: name for name in ENVIRONMENTS}),
            "room",
            "What is reflected: a room, or colours that are the directions.",
        ),
        "maps": word.FITTED_TEXELS(None, "The edge of the normal map."),
        "cube": word.FITTED_TEXELS(None, "The edge of the cube map's faces, and half the sphere map's."),
        "height_field": own_maps.height_field("the waves"),
        "height_scale": own_maps.HEIGHT_SCALE(0.03),
        "photograph": own_maps.PANORAMA,
    },
    methods=(
        Method("texture shaders", cube_scene, ("GEFORCE_3", "NV2A")),
        Method("offsets of a sphere map", offset_scene, ("G400",)),
    ),
    acceptance=checks,
)
