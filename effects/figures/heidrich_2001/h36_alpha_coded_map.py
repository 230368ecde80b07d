"""H36: a shadow map in the alpha channel of a picture from the light."""

import numpy as np

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import alpha_shadows
from fixedpipe.effects.geometry.views import Panel, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Scene
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding, picture_from_light, show_alpha
from fixedpipe.effects.shadows.lit_scene import LAMP_COLOR


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
    """What of the scene is in the map, and its lamp."""
    scene, light = alpha_shadows.lit_scene_of(size, lamp)
    return Scene(scene.throwing), light


def depths_from_the_lamp(size, lamp):
    """The linear depth, float64 [size, size], of what rays from the lamp meet, one where they meet nothing;
    and bool [size, size], where that is the depth of one surface: nothing else is seen in the pixels beside.
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
    snapped = (
        "vertices lie on sixteenths of a pixel, where a surface falls away; measured at the first picture"
    )
    for on, bound, reason in (
        (Answer.IDEAL, 0.08, snapped),
        (Answer.MACHINE, 0.33, "rounding to the nearest step alone gives sqrt(1/12) = .289; " + snapped),
    ):
        alpha = renderer.window(on, figure, _SIZE)[:, middle, 0]
        error = root_mean_square((alpha - depth)[whole & (depth < 1.0)]) * steps
        name = "RMS of alpha - depth, away from outlines, in steps of 1/255"
        yield Check(name, error, at_most=bound, on=on, reason=reason)
    scene, light = throwing_scene_of(_SIZE, lamp)
    shown = agreement.truth_of(scene, light.view(Panel(0, 0, _SIZE, _SIZE)), light).shown
    # The floor has no highlight: its colour is one amount of light times its own.
    floor = whole & (shown.object == 0)
    color = np.array(scene.objects[0].color) * np.array(LAMP_COLOR[:3])
    share = renderer.machine_window(figure, _SIZE)[:, :_SIZE][floor] / color
    yield Check(
        "the floor from the lamp: light of its three colours, largest spread",
        float(np.ptp(share, axis=1).max()),
        at_most=0.02,
        on=Answer.MACHINE,
        reason="a byte in each of two colours, of which 0.39 is the least at full light; measured 0.012",
    )
    yield Check(
        "the floor from the lamp: least light",
        float(share.min()),
        at_least=0.5,
        on=Answer.MACHINE,
        reason="a lamp sees what it lights, and no shadow",
    )
    seen = depth[whole & (depth < 1.0)]
    yield Check(
        "pixels of the map that those errors are of",
        float(whole.mean()),
        at_least=0.9,
        on=Answer.MACHINE,
        reason="outlines are thin",
    )
    yield Check(
        "depths from the nearest to the farthest that the light sees",
        float(seen.max() - seen.min()),
        at_least=0.9,
        on=Answer.MACHINE,
        reason="the lamp's planes enclose the scene closely, so that alpha's steps are small",
    )
    yield Check(
        "vertices of the scene outside the lamp's view",
        _outside(_SIZE, lamp),
        at_most=0.0,
        on=Answer.MACHINE,
        reason="what the lamp does not see is in no map (document 003's Z30)",
    )
    yield from alpha_shadows.agreement_checks(
        figure, renderer, board, _SIZE, 2, least=0.976, least_facing=0.985, other=9
    )


def reference(size, *, lamp, shading, background, **_):
    """The picture's shadows by rays; the map's panels have no reference."""
    return shadow_reference.row(size, [None, None, alpha_shadows.by_rays(size, lamp, background, shading)])


FIGURE = Figure(
    id="H36",
    title="An alpha-coded shadow map",
    caption=(
        "What throws shadows, as the lamp sees it; the alpha of the same picture, the depth from the lamp, "
        "as grey, which is the map; the camera's picture, with the shadows that the map tells of."
    ),
    must_see=(
        "Left: no shadow at all, the lamp lights all it sees. Middle: the same shapes, darker the nearer "
        "they are to the lamp, without any lighting, white where there is nothing. Right: a shadow on the "
        "floor from each thing, the ring's with a narrow gap."
    ),
    source="Heidrich2001",
    techniques=("H36",),
    panels=("from the lamp", "depth in alpha", "camera"),
    parameters=alpha_shadows.PARAMETERS,
    methods=(
        Method("one texture unit", make_scene(alpha_shadows.ONE_UNIT), ("OCTANE",)),
        Method("texture environments", make_scene(alpha_shadows.ENVIRONMENTS), ("MULTITEXTURE",)),
        Method("register combiners", make_scene(alpha_shadows.COMBINERS), ("GEFORCE_256",)),
    ),
    acceptance=checks,
    reference=reference,
)
