"""P5: linear depth compared with a z-buffer of the same number of bits.

A z-buffer's step at distance z is z^2 (f - n) / (f n) / (2^b - 1). The step of a linear depth is
(f - n) / (2^b - 1) everywhere. They are equal at sqrt(f n).

Source: Heidrich 2001, section 2.1 (artefact P5 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.draws import FIRST_PASS, REPLACE
from fixedpipe.effects.scenes.objects_and_lamps import Lamp
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.state import PassState

DATA = study_data(__file__, "P5")

NEAR, FAR, BITS = 1.0, 100.0, 8
# What the catalogue computed: distance, linear step, z-buffer step.
CATALOGUE = (
    (1.5, 0.388, 0.0087),
    (5.0, 0.388, 0.097),
    (10.0, 0.388, 0.39),
    (50.0, 0.388, 9.7),
    (95.0, 0.388, 35.0),
)
_WIDTH = 1024
_LAMP = Lamp((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), NEAR, FAR, field_of_view=90.0)


def depths(distances, coding, profile):
    """A machine's depths for distances from the light [1024]: alpha by a coding, in [0, 1], and the depth
    buffer's depth, two float64 [1024].

    The machine draws a row of pixels. Each pixel is a rectangle at its own distance.
    """
    edges = np.arange(_WIDTH + 1) / (_WIDTH / 2.0) - 1.0
    x = np.stack([edges[:-1], edges[1:], edges[1:], edges[:-1]], axis=-1) * distances[:, None]
    y = np.array([-1.0, -1.0, 1.0, 1.0]) * distances[:, None]
    positions = np.stack([x, y, np.broadcast_to(-distances[:, None], x.shape)], axis=-1).reshape(-1, 3)
    panel = Panel(0, 0, _WIDTH, 1)
    view = _LAMP.view(panel)
    state = PassState(
        vertex=view.vertex,
        texture_units=(coding.ramp_unit(_LAMP, view, environment=REPLACE),),
        depth_test=FIRST_PASS,
    )
    draw = Draw(label="depths", mesh=Mesh(positions, PrimitiveType.QUADS), state=state)
    framebuffer = execute((coding.ramp(profile), draw), profile, _WIDTH, 1).framebuffer
    alpha = framebuffer.color[0, :, 3] / (2.0**framebuffer.color_bits - 1.0)
    return alpha, framebuffer.depth[0] / (2.0**framebuffer.depth_bits - 1.0)


def linear_step(z, profile):
    """The distance over which alpha grows by one step near z: the mean of the steps within 10 units of z."""
    low, high = max(z - 10.0, NEAR), min(z + 10.0, FAR)
    distances = low + (high - low) * (np.arange(_WIDTH) + 0.5) / _WIDTH
    alpha, _ = depths(distances, Coding(BITS), profile)
    changes = np.nonzero(np.diff(alpha))[0]
    return float((distances[changes[-1]] - distances[changes[0]]) / (len(changes) - 1))


def z_buffer_step(z, profile):
    """The distance over which a depth buffer of ``BITS`` bits would grow by one step at z, from the slope of
    a wider depth buffer.
    """
    distances = z * (1.0 + 0.02 * (np.arange(_WIDTH) / (_WIDTH - 1.0) - 0.5))
    _, depth = depths(distances, Coding(BITS), profile)
    return float((distances[-1] - distances[0]) / (depth[-1] - depth[0]) / (2.0**BITS - 1.0))


def alphas_between(low, high, linear, profile):
    """How many different alphas there are between two distances."""
    distances = low + (high - low) * (np.arange(_WIDTH) + 0.5) / _WIDTH
    alpha, _ = depths(distances, Coding(BITS, linear=linear), profile)
    return len(np.unique(alpha))


def measure(profile):
    """The table, with a row for each distance of the catalogue."""
    rows = []
    for z, _, _ in CATALOGUE:
        rows.append(
            (
                z,
                linear_step(z, profile),
                (FAR - NEAR) / (2.0**BITS - 1.0),
                z_buffer_step(z, profile),
                z * z * (FAR - NEAR) / (FAR * NEAR) / (2.0**BITS - 1.0),
                alphas_between(z / 1.05, z * 1.05, True, profile),
                alphas_between(z / 1.05, z * 1.05, False, profile),
            )
        )
    columns = (
        Column("distance", form="g"),
        Column("linear step, machine", form=".4f"),
        Column("(f - n) / 255", form=".4f"),
        Column("z-buffer step, machine", form=".4f"),
        Column("law", form=".4f"),
        Column("alphas within 5 %, linear", form="d"),
        Column("alphas within 5 %, z-buffer", form="d"),
    )
    distances = NEAR + (FAR - NEAR) * (np.arange(_WIDTH) + 0.5) / _WIDTH
    curves = {
        name: np.stack([distances, depths(distances, Coding(BITS, linear=linear), profile)[0]])
        for name, linear in (("linear", True), ("z-buffer", False))
    }
    return Table(columns, tuple(rows), curves)


def _far_half(table, name):
    distances, alpha = table.curves[name]
    return len(np.unique(alpha[distances > 50.0]))


def findings(table):
    """Which depth is finer at which distance, and how many z-buffer values remain far away."""
    row = {r["distance"]: r for r in table.records()}
    near, far = row[1.5], row[95.0]
    return (
        f"At a distance of {1.5:g} a z-buffer's step is {near['z-buffer step, machine']:.4f}, at {95.0:g} "
        f"it is {far['z-buffer step, machine']:.1f}. Linear alpha's step is "
        f"{far['linear step, machine']:.3f} at both.",
        f"The steps are equal at sqrt(f n) = {math.sqrt(FAR * NEAR):g}: "
        f"{row[10.0]['z-buffer step, machine']:.3f} and {row[10.0]['linear step, machine']:.3f}.",
        f"Of {2**BITS} alphas, {_far_half(table, 'linear')} lie beyond a distance of 50 with the linear "
        f"ramp. If the ramp is read at a z-buffer's depths, {_far_half(table, 'z-buffer')} do.",
    )


def checks(table):
    """The catalogue's numbers."""
    row = {r["distance"]: r for r in table.records()}
    for z, linear, buffered in CATALOGUE:
        r = row[z]
        yield DATA.check(
            "linear step at {z:g}, of {linear:g}: relative deviation",
            abs(r["linear step, machine"] / linear - 1.0),
            Answer.MACHINE,
            z=z,
            linear=linear,
        )
        yield DATA.check(
            "z-buffer step at {z:g}, of {buffered:g}: relative deviation",
            abs(r["z-buffer step, machine"] / buffered - 1.0),
            Answer.MACHINE,
            z=z,
            buffered=buffered,
        )
    equal = row[10.0]
    yield DATA.check(
        "steps at sqrt(f n), linear over z-buffer: deviation from one",
        abs(equal["linear step, machine"] / equal["z-buffer step, machine"] - 1.0),
        Answer.MACHINE,
    )
    for name, wanted in (("linear", 255.0 * 50.0 / 99.0), ("z-buffer", 255.0 * 1.0 / 99.0)):
        yield DATA.check(
            "{name}: alphas beyond 50, of {wanted:.1f} steps and one: deviation",
            abs(_far_half(table, name) - wanted - 1.0),
            Answer.MACHINE,
            name=name,
            wanted=wanted,
        )


def plot(axes, table):
    """Steps by distance, and alpha by distance."""
    steps, values = axes
    z = table.column("distance")
    for name, color in (("linear", BLUE), ("z-buffer", ORANGE)):
        steps.loglog(z, table.column(f"{name} step, machine"), color=color, marker="o", label=name)
        values.plot(*table.curves[name], color=color, label=name)
    steps.loglog(z, [row[1] for row in CATALOGUE], label="catalogue", **EXPECTED)
    steps.loglog(z, [row[2] for row in CATALOGUE], **EXPECTED)
    steps.set_xlabel("distance from the light")
    steps.set_ylabel("distance that a step of 8 bits stands for")
    steps.legend()
    values.set_xlabel("distance from the light")
    values.set_ylabel("alpha")
    values.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"Rows of {_WIDTH} pixels at distances from {NEAR:g} to {FAR:g} from the light: where alpha by the "
        "ramp changes; and the slope of the machine's depth buffer, divided by 255."
    ),
    machines=("OCTANE", "GEFORCE_256", "MULTITEXTURE"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
