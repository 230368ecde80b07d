"""F003-9: a reflection, dirt, and the dirty reflection."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import arithmetic_check
from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import bumped_reflections, environments
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.bumps import map_normals, own_normals, texels
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, perspective_view, row_of_panels

DATA = figure_data(__file__, "F003-9")

EYE, FIELD_OF_VIEW = (0.0, 1.3, 3.4), 36.0


def dirt(edge):
    """What dirt leaves of the reflection, float64 [edge, edge] in [0, 1]: stains, and streaks along t."""
    s, t = height_fields.texel_centers(edge, edge)
    stains = height_fields.turbulence(s, t, 4, 4, 31)
    streaks = height_fields.value_noise(edge, edge, 32, 3, 9)
    return np.clip(0.68 + 1.3 * stains + 0.2 * streaks, 0.15, 1.0)


def waves(edge, relief):
    """Hammered metal: normals in tangent space, float64 [edge, edge, 3]."""
    return map_normals(relief * height_fields.smooth(height_fields.pebbles(edge, edge, 4, 3), 6))


def _surface(size):
    around = 24 if size < 64 else 64 if size < 200 else 96
    return surfaces.torus(around, around // 2, 0.72, 0.34).with_repeats(3, 1).rotated(rotation("x", 14.0))


def _metal(edge, relief, height_field, height_scale, photograph):
    """Normals, and what dirt leaves of the reflection."""
    if height_field is None:
        normals = waves(edge, relief)
    else:
        normals = own_normals(height_field, edge, edge, height_scale)
    return normals, photograph.brightness(edge, edge, repeated=True) if photograph else dirt(edge)


def cube_scene(profile, size, *, tint, second_pass, **metal):
    """F003-9 by texture shaders. ``second_pass``: dirt is a separate draw, and not the normal map's alpha."""
    edge, surface = texels(size), _surface(size)
    loading, names = bumped_reflections.load(*_metal(edge, **metal), "hammered metal", profile)
    out = [bumped_reflections.load_environment(2 * texels(size), profile, environments.room), *loading]
    for number, panel in enumerate(row_of_panels(3, size)):
        view = perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW, radius=1.2)
        out += (panel.clear(BACKGROUND), *bumped_reflections.backdrop(view))
        if number == 1:
            out += bumped_reflections.dirt_pass(surface, names, view, alone=True)
            continue
        dirty = number == 2
        out += bumped_reflections.reflection_pass(
            surface, names, view, dirt=dirty and not second_pass, tint=tint
        )
        if dirty and second_pass:
            out += bumped_reflections.dirt_pass(surface, names, view)
    return tuple(out)


def offset_scene(profile, size, *, tint, second_pass, **metal):
    """F003-9 by offsets of a sphere map; dirt is a second draw, as both units are taken. ``tint`` and
    ``second_pass`` take no part.
    """
    edge, surface = texels(size), _surface(size)
    parts = (8, 6) if size < 64 else (18, 8)
    loading, names = bumped_reflections.load_offsets(*_metal(edge, **metal), "hammered metal", profile)
    out = list(loading)
    for number, panel in enumerate(row_of_panels(3, size)):
        view = perspective_view(panel, EYE, field_of_view=FIELD_OF_VIEW, radius=1.2)
        load, show = bumped_reflections.picture_backdrop(view, edge, profile)
        if number == 0:
            out += (bumped_reflections.load_sphere_map(2 * edge, view, profile), load)
        out += (panel.clear(BACKGROUND), show)
        if number == 1:
            out += bumped_reflections.dirt_pass(surface, names, view, alone=True)
            continue
        out += bumped_reflections.offset_passes(surface, names, view, across=parts[0], along=parts[1])
        if number == 2:
            out += bumped_reflections.dirt_pass(surface, names, view)
    return tuple(out)


def _by_rays(size, p):
    """The clean ring by rays, in float64: which pixels show it, bool [size, size], bottom row first.

    Then what they mirror, what a ring without bumps mirrors, and the first's mean: [n, 3], [n, 3] and [3].
    """
    view = perspective_view(Panel(0, 0, size, size), EYE, field_of_view=FIELD_OF_VIEW, radius=1.2)
    seen = seen_places.surface(_surface(size), view)
    along = primary_rays(view)[1].reshape(size, size, 3)[seen.where]
    to_eye = -seen_places.unit(along)

    def mirrored(normals):
        toward = 2.0 * (normals * to_eye).sum(axis=-1, keepdims=True) * normals - to_eye
        return environments.room(toward) * np.array(p["tint"])

    bumps = seen_places.looked_up(waves(texels(size), p["relief"]), seen)
    whole = mirrored(seen_places.unit((bumps[:, None] @ seen.frames)[:, 0]))
    return seen.where, whole, mirrored(seen.frames[:, 2]), whole.mean(axis=0)


def _displayed_checks(figure, renderer):
    """What the first ring mirrors, and the room behind the three."""
    size = figure.size
    where, *true = _by_rays(size, figure.values)
    near = where.copy()
    for axis in (0, 1):
        near = np.any([np.roll(near, step, axis) for step in range(-2, 3)], axis=0)
    for on in Answer:
        panels = [panel_of(np.clip(renderer.window(on, figure, size), 0.0, 1.0), k) for k in range(3)]
        behind = [np.abs(panel - panels[0])[~near].max() for panel in panels[1:]]
        yield DATA.check("the room behind, off the first panel's, largest", float(max(behind)), on)
        if renderer.method.name != "offsets of a sphere map":  # its offsets are secants
            yield DATA.check(
                "clean ring: of what room and bumps change, the least share that is seen",
                least_share(panels[0][where], *true),
                on,
            )


def checks(figure, renderer):
    """That the third panel is the first times the second, and that both differ from it."""
    size = 128
    image = renderer.machine_window(figure, size)
    clean, alone, dirty = (panel_of(image, k) for k in range(3))
    covered = np.abs(clean - alone).max(axis=-1) > 0.0
    error = np.abs(dirty - clean * alone)[covered]
    exact = np.clip(renderer.ideal_window(figure, size), 0.0, 1.0)
    clean_exact, alone_exact, dirty_exact = (panel_of(exact, k) for k in range(3))
    seen = np.abs(clean_exact - alone_exact).max(axis=-1) > 0.0
    return (
        DATA.check(
            "dirty - clean times dirt, largest",
            float(np.abs(dirty_exact - clean_exact * alone_exact)[seen].max()),
            Answer.IDEAL,
        ),
        DATA.check("dirty - clean times dirt, largest, in bytes", 255.0 * float(error.max()), Answer.MACHINE),
        DATA.check(
            "share of the object that dirt makes darker by more than 0.1",
            float((np.abs(dirty - clean).max(axis=-1)[covered] > 0.1).mean()),
            Answer.MACHINE,
        ),
        arithmetic_check(figure, renderer, 0.019, "8-bit normals, as F003-8's; a third of slack"),
        *_displayed_checks(figure, renderer),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "relief": word.RELIEF(0.16),
        "tint": word.COLOR(
            (1.0, 0.86, 0.62), "What the reflection is multiplied by, where texture shaders draw it."
        ),
        "second_pass": word.FLAG(
            False, "Whether dirt is drawn by itself; with offsets of a sphere map it always is."
        ),
        "height_field": own_maps.height_field("the hammered metal's relief"),
        "height_scale": own_maps.HEIGHT_SCALE(0.1),
        "photograph": own_maps.photograph("the dirt: where it is dark, little is left of the reflection"),
    },
    methods=(
        Method("texture shaders", cube_scene, ("GEFORCE_3",)),
        Method("texture shaders, dirt as a second pass", cube_scene, ("NV2A",), {"second_pass": True}),
        Method("offsets of a sphere map", offset_scene, ("G400",)),
    ),
    acceptance=checks,
)
