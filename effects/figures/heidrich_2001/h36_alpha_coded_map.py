"""H36: a shadow map in the alpha channel of a picture from the light."""

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import alpha_shadows
from fixedpipe.effects.geometry.views import Panel, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding, picture_from_light, show_alpha
from fixedpipe.effects.shadows.lit_scene import LAMP_COLOR

DATA = figure_data(__file__, "H36")


def make_scene(board):
    """The scene drawn in a board's way."""

    def scene(profile, size, *, lamp, ratio, bits, bias, background, shading):
        """H36: the picture from the light, its alpha as grey, and the picture from the camera."""
        left, middle, right = row_of_panels(3, size)
        things, light = alpha_shadows.lit_scene_of(size, lamp)
        plain, biased = Coding(bits, bias=0.0), Coding(bits, bias=bias - board.free)
        common = {"lamp": lamp, "shading": shading}
        return (
            plain.ramp(profile),
            *picture_from_light(things, light, left, plain, bias=0.0, shading=shading, background=background),
            *picture_from_light(things, light, middle, plain, bias=0.0, shading=shading),
            show_alpha(middle),
            *alpha_shadows.stored(right, profile, board, biased, ratio=ratio, **common),
            *alpha_shadows.compared(right, profile, board, biased, background=background, **common),
        )

    return scene


_BOARDS = {
    "register combiners": alpha_shadows.COMBINERS,
    "texture environments": alpha_shadows.ENVIRONMENTS,
    "one texture unit": alpha_shadows.ONE_UNIT,
}
_SIZE = 256


def throwing_scene_of(size, lamp):
    """The part of the scene that is in the map, and its lamp."""
    scene, light = alpha_shadows.lit_scene_of(size, lamp)
    return Scene(scene.throwing), light


def depths_from_the_lamp(size, lamp):
    """The linear depth, float64 [size, size], at which rays from the lamp meet the scene, one where they meet
    nothing; and bool [size, size], true where the neighbouring pixels show the same surface.
    """
    scene, light = throwing_scene_of(size, lamp)
    view = light.view(Panel(0, 0, size, size))
    known = agreement.truth_of(scene, view, light)
    shown, plane = known.shown, np.array(light.depth_plane)
    depth = np.where(shown.something, shown.points @ plane[:3] + plane[3], 1.0)
    whole = ~agreement.silhouettes(known)
    for axis in (0, 1):
        for step in (-1, 1):
            whole &= np.roll(shown.something, step, axis) == shown.something
    return depth, whole


def _outside(size, lamp):
    """How many of the scene's vertices have no place in the map, or no depth from zero to one."""
    scene, light = throwing_scene_of(size, lamp)
    points = scene.triangles().reshape(-1, 3)
    s, t, r, q = (points @ np.array(row[:3]) + row[3] for row in light.texture_matrix)
    held = [(a >= 0.0) & (a <= q) for a in (s, t, r)]
    return float((~np.all(held, axis=0)).sum())


def checks(figure, renderer):
    """The map's alpha against depths by rays, and the shadows that it throws."""
    board, lamp = _BOARDS[renderer.method.name], figure.values["lamp"]
    depth, whole = depths_from_the_lamp(_SIZE, lamp)
    middle = slice(_SIZE, 2 * _SIZE)
    steps = 2.0 ** figure.values["bits"] - 1.0
    for on in Answer:
        alpha = renderer.window(on, figure, _SIZE)[:, middle, 0]
        error = root_mean_square((alpha - depth)[whole & (depth < 1.0)]) * steps
        yield DATA.check("RMS of alpha - depth, away from outlines, in steps of 1/255", error, on)
    scene, light = throwing_scene_of(_SIZE, lamp)
    shown = agreement.truth_of(scene, light.view(Panel(0, 0, _SIZE, _SIZE)), light).shown
    # The floor has no highlight: its colour is one amount of light times its own.
    floor = whole & (shown.object == 0)
    color = np.array(scene.objects[0].color) * np.array(LAMP_COLOR[:3])
    share = renderer.machine_window(figure, _SIZE)[:, :_SIZE][floor] / color
    yield DATA.check(
        "the floor from the lamp: light of its three colours, largest spread",
        float(np.ptp(share, axis=1).max()),
        Answer.MACHINE,
    )
    yield DATA.check("the floor from the lamp: least light", float(share.min()), Answer.MACHINE)
    seen = depth[whole & (depth < 1.0)]
    yield DATA.check("pixels of the map that those errors are of", float(whole.mean()), Answer.MACHINE)
    yield DATA.check(
        "depths from the nearest to the farthest that the light sees",
        float(seen.max() - seen.min()),
        Answer.MACHINE,
    )
    yield DATA.check("vertices of the scene outside the lamp's view", _outside(_SIZE, lamp), Answer.MACHINE)
    yield from alpha_shadows.agreement_checks(
        figure, renderer, board, _SIZE, 2, least=0.976, least_facing=0.985, other=9
    )


def reference(size, *, lamp, shading, background, **_):
    """The picture's shadows by rays; the map's panels have no reference."""
    return shadow_reference.row(size, [None, None, alpha_shadows.by_rays(size, lamp, background, shading)])


FIGURE = Figure(
    **DATA.words,
    parameters=alpha_shadows.PARAMETERS,
    methods=(
        Method("one texture unit", make_scene(alpha_shadows.ONE_UNIT), ("OCTANE",)),
        Method("texture environments", make_scene(alpha_shadows.ENVIRONMENTS), ("MULTITEXTURE",)),
        Method("register combiners", make_scene(alpha_shadows.COMBINERS), ("GEFORCE_256",)),
    ),
    acceptance=checks,
    reference=reference,
)
