"""H22: a mirror added to a radiosity solution, by blending and by the accumulation buffer (H23)."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import (
    environments,
    fresnel_passes,
    mirror_passes,
    prefilter,
    reflections,
)
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import cube_maps, surfaces
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import reflected
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, MODULATE, draw
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.radiosity import light_maps, small_room
from fixedpipe.effects.radiosity.form_factors import Ball
from fixedpipe.effects.radiosity.progressive_refinement import solve
from fixedpipe.pipeline.commands import TexImage

DATA = figure_data(__file__, "H22")

EYE, CENTER, FIELD_OF_VIEW = (-0.1, 1.02, 2.7), (-0.26, 0.74, 0.0), 37.0
# On the chest.
MIDDLE, RADIUS = (-0.42, 0.88, 0.12), 0.28
BALL = Ball(MIDDLE, RADIUS)
THINGS = (*small_room.BOXES.values(), BALL)
MIRROR = "what the ball sees"


def detail(size):
    """Segments of the ball, and elements along a wall's edge, for a panel of ``size`` pixels."""
    return (16, 8) if size < 64 else (64, 16) if size < 200 else (128, 32)


@lru_cache(maxsize=4)
def solved(elements, edge, exposure):
    """The visible walls, light maps, and cube maps of the room as the ball sees it, sharp and filtered by the
    cosine.

    All are clamped to one, the most that textures hold, except for maps that are still to be filtered.
    """
    room = small_room.small_room(elements)
    maps = light_maps.light_maps(room, solve(room, THINGS).radiosity, THINGS, exposure)

    def seen(toward):
        return light_maps.seen(room, maps, MIDDLE, toward)

    diffuse = prefilter.cosine(environments.faces(64, seen), 64)
    shown = tuple(rectangle for rectangle in room if rectangle.name != small_room.FRONT)
    maps = {name: np.minimum(values, 1.0) for name, values in maps.items()}
    return shown, maps, environments.faces(edge, seen), diffuse


def ball(segments):
    """The ball on the chest."""
    return surfaces.sphere(segments, segments // 2).scaled(RADIUS).moved(*MIDDLE)


def camera(panel):
    """The view of the room."""
    return perspective_view(panel, EYE, CENTER, FIELD_OF_VIEW)


def _diffuse(shown, surface, colors, view, weight):
    """All that is diffuse, times a weight: a draw for each wall and one for the ball."""
    walls = [
        replace(
            command,
            mesh=mirror_passes.weighted_mesh(command.mesh, weight),
            state=replace(
                command.state,
                texture_units=(replace(command.state.texture_units[0], environment=MODULATE),),
            ),
        )
        for command in light_maps.passes(shown, view, EDGE)
    ]
    label = f"diffuse light on the ball, times {weight:g}"
    mesh = surface.mesh(colors=colors * weight)
    return (*walls, draw(label, mesh, view, None, depth_test=FIRST_PASS, polygon=mirror_passes.FRONT))


def _load_cube(cube, view, profile):
    return reflections.load_cube(MIRROR, cube, profile)


def _load_sphere(cube, view, profile):
    image = environments.sphere_map(2 * cube.shape[1], view, profile, cube_maps.Seen(cube))
    return TexImage(label=f"load {MIRROR}", texture=MIRROR, image=image)


def make_scene(load, read):
    """The figure's scene.

    load  (cube, view, profile) -> the command that loads the room as the ball sees it
    read  (texture, view) -> the texture unit that reads its reflections
    """

    def scene(profile, size, *, k_d, k_s, paint, exposure, background):
        segments, elements = detail(size)
        edge = min(max(1 << (size - 1).bit_length(), 16), 256)
        shown, maps, cube, irradiance = solved(elements, edge, exposure)
        surface = ball(segments)
        light = np.minimum(cube_maps.look_up(irradiance, surface.normals) * np.array(paint), 1.0)
        colors = colors_of(factor_texels(light, profile))
        panels = row_of_panels(4, size)
        views = [camera(panel) for panel in panels]
        out = [
            *light_maps.load({rectangle.name: maps[rectangle.name] for rectangle in shown}, profile),
            load(np.minimum(cube, 1.0), views[0], profile),
        ]
        for number, (panel, view) in enumerate(zip(panels, views, strict=True)):
            mirror = read(MIRROR, view)
            out.append(panel.clear(background if number == 0 else (0.0, 0.0, 0.0)))
            if number == 1:
                out += _diffuse(shown, surface, colors, view, 0.0)
                out.append(mirror_passes.mirror_pass(surface, view, mirror, k_s))
            elif number == 3:
                whole = mirror_passes.mirror_pass(surface, view, mirror)
                diffuse = _diffuse(shown, surface, colors, view, 1.0)
                out += mirror_passes.accumulated(panel, diffuse, (whole,), k_d, k_s)
            else:
                out += _diffuse(shown, surface, colors, view, k_d)
                if number == 2:
                    out.append(mirror_passes.mirror_pass(surface, view, mirror, k_s, added=True))
        return tuple(out)

    return scene


def ball_by_rays(view):
    """Pixels of the ball: normals and vectors to the eye [size, size, 3], and which are its: bool."""
    size = view.panel.height
    _, along = primary_rays(view)
    along = normalize(along)
    away = np.broadcast_to((np.array(view.eye) - np.array(MIDDLE)) / RADIUS, along.shape)
    middle = dot(along, away)
    under = middle * middle - (dot(away, away) - 1.0)
    normals = normalize(away + (-middle - np.sqrt(np.maximum(under, 0.0)))[:, None] * along)
    square = (size, size, 3)
    # A little within, where no pixel shows what is behind.
    inside = (under > 0.0) & (dot(normals, -along) > 0.25)
    return normals.reshape(square), -along.reshape(square), inside.reshape(size, size)


def walls_by_rays(view, shown, maps):
    """Of each rectangle that rays meet apart from the ball: which pixels show it, bool [size, size].

    Then its light there, its map's mean, and its light with the map upside down: float64 [n, 3] each.
    """
    size, eye = view.panel.height, np.array(view.eye)
    _, along = primary_rays(view)
    number, s, t = light_maps.nearest(shown, np.broadcast_to(eye, along.shape), along)
    to_ball = np.array(MIDDLE) - eye
    past = np.sqrt(np.maximum(dot(to_ball, to_ball) - dot(normalize(along), to_ball) ** 2, 0.0))
    inner, own = (past > 1.1 * RADIUS).reshape(size, size), number.reshape(size, size)
    for axis in (0, 1):
        for step in (-2, -1, 1, 2):
            inner = inner & (np.roll(own, step, axis) == own)
    for k, rectangle in enumerate(shown):
        at = (number == k) & inner.ravel()
        if at.any():
            texels = maps[rectangle.name]
            whole, turned = (light_maps.look_up(v, s[at], t[at]) for v in (texels, texels[::-1]))
            mean = np.broadcast_to(texels.mean(axis=(0, 1)), whole.shape)
            yield at.reshape(size, size), whole, mean, turned


def _wall_checks(figure, renderer):
    """The room's light maps in the first panel."""
    size, k_d = figure.size, figure.values["k_d"]
    shown, maps, _, _ = solved(detail(size)[1], 256, figure.values["exposure"])
    walls = list(walls_by_rays(camera(Panel(0, 0, size, size)), shown, maps))
    for on in Answer:
        panel, shares = panel_of(renderer.window(on, figure, size), 0), []
        for at, whole, *others in walls:
            # Bytes tell nothing of a change that is nowhere seen.
            seen = [k_d * other for other in others if np.abs(whole - other).max() > 8.0 / 255.0]
            shares += [least_share(panel[at], k_d * whole, other) for other in seen]
        yield DATA.check(
            "walls: of what their light maps change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """The ball against the equation at each pixel, and what either way loses to rounding."""
    size, values = 160, figure.values
    view = camera(row_of_panels(1, size)[0])
    normals, eye, inside = ball_by_rays(view)
    _, elements = detail(size)
    _, _, cube, irradiance = solved(elements, 256, values["exposure"])
    under = np.minimum(cube_maps.look_up(irradiance, normals[inside]) * np.array(values["paint"]), 1.0)
    over = cube_maps.look_up(np.minimum(cube, 1.0), reflected(eye, normals)[inside])
    true = values["k_d"] * under + values["k_s"] * over
    pictures = {}
    for on in Answer:
        image = renderer.window(on, figure, size)
        pictures[on] = [image[:, k * size : (k + 1) * size] for k in range(4)]
    for on in Answer:
        for name, k, expected in (
            ("diffuse: the ball", 0, values["k_d"] * under),
            ("mirror: the ball", 1, values["k_s"] * over),
        ):
            yield DATA.check(
                "{name} against its own term at each pixel's normal, RMS",
                root_mean_square(pictures[on][k][inside] - expected),
                on,
                name=name,
            )
    ideal, machine = (pictures[on] for on in Answer)
    for name, panel in (("blending", ideal[2]), ("accumulation", ideal[3])):
        yield DATA.check(
            "{name}: the ball against k_d L_d + k_s L_m at each pixel's normal, RMS",
            root_mean_square(panel[inside] - true),
            Answer.IDEAL,
            name=name,
        )
    yield DATA.check(
        "accumulation against blending, largest difference", np.abs(ideal[3] - ideal[2]).max(), Answer.IDEAL
    )
    yield DATA.check(
        "sum less its two terms, largest", np.abs(ideal[2] - ideal[0] - ideal[1])[inside].max(), Answer.IDEAL
    )
    lost = [root_mean_square((machine[k] - ideal[k])[inside]) for k in (2, 3)]
    yield DATA.check(
        "accumulation's RMS from the ideal over blending's, on the ball",
        lost[1] / lost[0],
        Answer.MACHINE,
        at_most=0.95 if renderer.profile.framebuffers.color_bits[0] == 8 else 1.0,
    )
    yield DATA.check(
        "accumulation against blending, steps of a byte",
        255.0 * np.abs(machine[3] - machine[2]).max(),
        Answer.MACHINE,
    )
    yield from _wall_checks(figure, renderer)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "k_d": word.SHARE(0.85, "What diffuse light is multiplied by."),
        "k_s": word.SHARE(0.3, "What the mirror is multiplied by."),
        "paint": word.COLOR((0.16, 0.36, 0.3), "The ball's own colour."),
        "exposure": word.NUMBER(1.15, "What the solution is multiplied by.", low=0.01, high=100.0),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method(
            "a cube map",
            make_scene(_load_cube, fresnel_passes.cube_unit),
            ("GEFORCE_256", "GEFORCE_3", "NV2A", "FUTURE"),
        ),
        Method(
            "a sphere map",
            make_scene(_load_sphere, lambda texture, view: fresnel_passes.sphere_unit(texture)),
            ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY"),
        ),
    ),
    acceptance=checks,
)
