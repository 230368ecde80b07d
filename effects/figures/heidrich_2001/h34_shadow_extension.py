"""H34: the shadow extension with its comparison in the stencil buffer, next to the form that includes ambient
light.
"""

import numpy as np

from fixedpipe.effects.acceptance import agreement, ray_caster, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.scenes.still_life import still_life_and_lamp, still_life_view
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import ambient_form_pass, scene_passes, stencil_passes, store_map
from fixedpipe.pipeline.commands import Draw

DATA = figure_data(__file__, "H34")


def make(profile, size, *, ratio, factor, share, from_red, shading):
    """Left: P1 to P3 with the stencil. Right: one pass.

    ``share``: the share of the light that remains in shadow on the right. ``from_red``: a copy turns the
    comparison into alpha, for machines whose comparison is a luminance.
    """
    left, right = row_of_panels(2, size)
    scene, light = still_life_and_lamp(size)
    return (
        *store_map(scene, light, "shadow map", map_edge(size, ratio), (2 * size, size), factor=factor),
        left.clear(BACKGROUND),
        right.clear(BACKGROUND),
        *stencil_passes(
            scene, still_life_view(left), light, "shadow map", profile, shading, from_red=from_red
        ),
        *ambient_form_pass(
            scene,
            still_life_view(right),
            light,
            "shadow map",
            profile,
            share,
            shading,
            combiners=not from_red,
        ),
    )


_SIZE = 192


# Those of the things that turn away from the light all round.
_ROUND = ("ring", "vase", "sphere")
# The largest cosine between a surface and the light where it turns away: a twelfth of the lamp's light.
_TURNING = 1.0 / 12.0


def _stairs(panel, mask, where):
    """By what share the darker of two neighbouring pixels is darker, the mean where the ``mask`` lights one.

    Zero where it nowhere lights one of two.
    """
    found = []
    for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        at = where[one] & where[other] & (mask[one] != mask[other])
        pair = np.stack([panel[side][at].sum(axis=-1) for side in (one, other)])
        found.append(1.0 - pair.min(axis=0) / pair.max(axis=0))
    found = np.concatenate(found)
    return float(found.mean()) if len(found) else 0.0


def _turning_checks(figure, renderer):
    """Where round things turn away from the light, and the ring's highlights."""
    values, size = figure.values_of(renderer.method), figure.size
    scene, light = still_life_and_lamp(size)
    view = still_life_view(Panel(0, 0, size, size))
    truth = agreement.truth_of(scene, view, light)
    turning = np.abs(agreement.cosines(truth)) < _TURNING
    # Stairs are edges where no ray has one.
    for step in (-1, 1):
        for axis in (0, 1):
            turning &= np.roll(truth.lit, step, axis) == truth.lit
    turning &= ~agreement.silhouettes(truth)
    things = {thing.name: k for k, thing in enumerate(scene.objects)}
    for on in Answer:
        masks = renderer.window(on, figure, size, shading=SceneShading.MASK)
        picture = renderer.window(on, figure, size)
        mask = panel_of(masks, 1)[..., 0] > 0.5 * (1.0 + values["share"])
        for k, extreme, bound in ((0, max, "at_most"), (1, min, "at_least")):
            steps = [
                _stairs(panel_of(picture, k), mask, turning & (truth.shown.object == things[name]))
                for name in _ROUND
            ]
            yield DATA.check(
                "{name}: where round things turn away from the light, the comparison's stairs, share",
                extreme(steps) / (1.0 - values["share"]),
                on,
                name=figure.panels[k],
                **{bound: 0.5},
            )
    red = np.clip(panel_of(renderer.machine_window(figure, size), 1)[..., :1], 0.0, 1.0)
    whole, loose, glows = _clamped(scene, view, light, truth)
    yield DATA.check(
        "one pass: of what clamping at vertices changes in the ring's highlights, the share that is seen",
        least_share(red[glows], whole[glows], loose[glows]),
        Answer.MACHINE,
    )


def _clamped(scene, view, light, truth):
    """Red of the lit ring, clamped at vertices and interpolated then, and the other way round: float64 [size,
    size, 1]. Then where they differ by more than a byte's step: bool [size, size].
    """
    unlit, lit = shadow_reference.corner_light(shadow_reference.Shot(scene, view, (light,)))
    triangle = truth.shown.triangle
    hits = truth.caster.nearest(*ray_caster.primary_rays(view), 1.0)
    weights = hits.barycentrics.reshape(*triangle.shape, 3)
    at = unlit[triangle][..., None, :1] + lit[0][triangle][..., :1]
    whole, loose = ((weights[..., None] * one).sum(axis=-2) for one in (np.minimum(at, 1.0), at))
    loose = np.minimum(loose, 1.0)
    ring = [thing.name for thing in scene.objects].index("ring")
    where = (truth.shown.object == ring) & truth.lit & ~agreement.silhouettes(truth)
    return whole, loose, where & ((loose - whole)[..., 0] > 1.0 / 255.0)


def checks(figure, renderer):
    """Both masks against rays and against each other; the numbers of passes (E000.8)."""
    parameters = figure.values_of(renderer.method)
    share, edge = parameters["share"], map_edge(_SIZE, parameters["ratio"])
    scene, light = still_life_and_lamp(_SIZE)
    truth = agreement.truth_of(scene, still_life_view(Panel(0, 0, _SIZE, _SIZE)), light)
    ground, outline = truth.shown.object == 0, agreement.silhouettes(truth)
    for on in Answer:
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK)
        left, right = (picture[:, k * _SIZE : (k + 1) * _SIZE] for k in range(2))
        masks = agreement.lit_mask(left), right[..., 0] > 0.5 * (1.0 + share)
        for name, mask in zip(("stencil", "one pass"), masks, strict=True):
            told = {"map_edge": edge}
            on_floor = agreement.compare(mask, truth, where=ground, **told)
            yield DATA.check("{name}: floor that agrees with rays", on_floor.agreeing, on, name=name)
            yield DATA.check("{name}: floor of no understood kind", on_floor.other, on, name=name)
        shadowed = right[ground & ~masks[1] & ~outline][:, 0]
        yield DATA.check("pixels where both forms find the same", float((masks[0] == masks[1]).mean()), on)
        yield DATA.check(
            "one pass: what shadows keep, distance from the share asked for",
            float(np.abs(shadowed - share).max()),
            on,
            at_most=1e-9 if on is Answer.IDEAL else 1.5 / 255.0,
        )
    yield from _turning_checks(figure, renderer)
    # With a map that the window holds.
    commands = figure.commands(renderer.profile, _SIZE, renderer.method, ratio=1)
    times = [
        sum(isinstance(c, Draw) and c.state.vertex.viewport == panel.viewport for c in commands)
        // len(scene.objects)
        for panel in row_of_panels(2, _SIZE)
    ]
    times.append(scene_passes(commands, scene) - sum(times))
    for name, drawn, expected in zip(
        ("with the stencil", "in one pass", "for the map"), times, (3, 1, 1), strict=True
    ):
        yield DATA.check(
            "times the scene is drawn {name}, off {expected}",
            abs(drawn - expected),
            Answer.MACHINE,
            name=name,
            expected=expected,
        )


BY_ALPHA = "alpha test of the comparison; combiners in the place of SHADOW_AMBIENT"
BY_COPY = "red copied to alpha; SHADOW_AMBIENT"


def reference(size, *, share, shading, **_):
    """The shadows by rays; on the right they keep ``share`` of all light."""
    scene, light = still_life_and_lamp(size)
    view = still_life_view(Panel(0, 0, size, size))
    shots = [
        shadow_reference.Shot(scene, view, (light,), shading=shading, in_shadow=kept)
        for kept in (None, share)
    ]
    return shadow_reference.row(size, shots)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(2),
        "factor": word.FACTOR(2.2),
        "share": word.SHARE(0.4, "The share of the light that stays in shadow on the right."),
        "from_red": word.FLAG(
            False, "Whether a copy makes alpha of the comparison's luminance, as some machines must."
        ),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(
        Method(BY_COPY, make, ("INFINITE_REALITY",), {"from_red": True}),
        Method(BY_ALPHA, make, ("GEFORCE_3", "NV2A")),
    ),
    acceptance=checks,
    reference=reference,
)
