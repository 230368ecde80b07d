"""Counts of shadow volumes: the stencil buffer's by z-pass and by z-fail, and those of rays. F003-25, F003-26
and Z23 compare them.
"""

import numpy as np

from fixedpipe.effects.acceptance.agreement import compare, lit_mask, truth_of
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.scenes.objects_and_lamps import Lamp
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading


def lamp_without_frustum(light, infinite=False):
    """The light: it has no frustum, a shadow volume needs none."""
    return Lamp(light, (0.0, 0.0, 0.0), 0.1, 40.0, infinite=infinite)


def counted(renderer, algorithm, view, objects, lamp, on, **way):
    """The stencil's counts and the lit mask after an algorithm, bottom row first; the panel is the window.

    ``way``: the algorithm's other arguments (operations, start).
    """
    panel, profile = view.panel, renderer.profile
    passes = algorithm(objects, view, lamp, profile, SceneShading.MASK, **way)
    commands = (panel.clear((0.0, 0.0, 0.0)), *passes)
    if on is Answer.MACHINE:
        buffers = renderer.execute(commands, profile, panel.width, panel.height).framebuffer
        color = buffers.color[..., :3] / (2.0**buffers.color_bits - 1.0)
    else:
        buffers = renderer.execute_ideal(commands, panel.width, panel.height)
        color = buffers.color[..., :3]
    return buffers.stencil[::-1].astype(np.int64), lit_mask(color[::-1])


def expected_counts(volumes, truth, start=0.0):
    """Z21's counter at each pixel's surface, int64 [h, w], zero in empty pixels."""
    seen, eye = truth.shown.something, np.array(truth.view.eye)
    points = truth.shown.points[seen]
    out = np.zeros(seen.shape, np.int64)
    # What is lit is on a front cap: outside, as the depth test LESS has it.
    out[seen] = shadow_volumes.ray_counter(volumes, truth.view.eye, points + 1e-9 * (eye - points), start)
    return out


def known_counts(objects, view, lamp):
    """The Truth by rays, and how many volumes each pixel's surface is in. It depends on no machine, so that a
    figure's machines may share it.
    """
    truth = truth_of(objects, view, lamp)
    return truth, expected_counts(shadow_volumes.shadow_volumes(objects, lamp.homogeneous), truth)


def count_checks(renderer, view, objects, lamp, least, reason, known=None):
    """Both algorithms' counts against rays, and their masks' unexplained differences.

    ``known``: ``known_counts`` of these, where they are there already.
    """
    truth, expected = known or known_counts(objects, view, lamp)
    for name, algorithm in (("z-pass", shadow_volumes.z_pass), ("z-fail", shadow_volumes.z_fail)):
        for on in Answer:
            counts, mask = counted(renderer, algorithm, view, objects, lamp, on)
            equal = float((counts == expected)[truth.shown.something].mean())
            yield Check(
                f"{name}: pixels whose count is the rays'", equal, at_least=least, on=on, reason=reason
            )
            yield Check(
                f"{name}: pixels lit or not unlike the rays', not on an edge",
                compare(mask, truth).other,
                at_most=0.0,
                on=on,
                reason="shadow volumes are exact in the picture: only edges may differ, by a pixel",
            )
