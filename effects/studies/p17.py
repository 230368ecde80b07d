"""P17: Banks' model with R*(s) = 1 - s in the place of the square root.

Source: Kautz, Seidel 2000, section 3.1 (artefact P17 of the catalogue).
"""

import numpy as np

from effects.figures import Check
from effects.figures.measures import root_mean_square
from effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table

# Samples along either axis of the square of v.t and l.t; odd, so that the middle of an edge is one.
_SAMPLES = 401


def bracket(view, light, root):
    """Banks' (sqrt(1 - (v.t)^2) sqrt(1 - (l.t)^2) - (v.t)(l.t))+ of v.t and l.t; without ``root`` the square
    roots are left out.
    """
    under = (1.0 - view * view) * (1.0 - light * light)
    return np.maximum(0.0, (np.sqrt(under) if root else under) - view * light)


def _regions(samples):
    axis = np.arange(samples) * (2.0 / (samples - 1)) - 1.0
    view, light = np.meshgrid(axis, axis)
    return {
        "whole square": (view, light),
        "cone l.t = -v.t": (axis, -axis),
        "v.t = 0": (0.0 * axis, axis),
        "|v.t|, |l.t| <= 1/2": tuple(
            a[np.maximum(np.abs(view), np.abs(light)) <= 0.5] for a in (view, light)
        ),
    }


def measure(_):
    """A row for each part of the square."""
    rows = []
    for name, (view, light) in _regions(_SAMPLES).items():
        error = bracket(view, light, False) - bracket(view, light, True)
        worst = int(np.abs(error).argmax())
        at = abs(float(view.flat[worst])), abs(float(light.flat[worst]))
        rows.append((name, root_mean_square(error), float(error.mean()), float(np.abs(error).max()), *at))
    columns = (
        Column("where"),
        Column("RMS", form=".4f"),
        Column("mean", form=".4f"),
        Column("largest", form=".4f"),
        Column("there |v.t|", form=".3f"),
        Column("there |l.t|", form=".3f"),
    )
    axis = np.arange(_SAMPLES) * (2.0 / (_SAMPLES - 1)) - 1.0
    view, light = np.meshgrid(axis, axis)
    curves = {
        "error": bracket(view, light, False) - bracket(view, light, True),
        "v.t": axis,
        "R": bracket(axis, -axis, True),
        "R*": bracket(axis, -axis, False),
    }
    return Table(columns, tuple(rows), curves)


def findings(table):
    """How much is lost and where."""
    whole, cone = table.records()[:2]
    return (
        f"R* makes Banks' bracket darker: by {-whole['mean']:.3f} in the mean of the square of v.t and l.t, "
        f"with an RMS of {whole['RMS']:.3f}.",
        f"On the cone of mirror directions, where the bracket is 1, it loses up to {cone['largest']:.3f}, at "
        f"(v.t)^2 = {cone['there |v.t|'] ** 2:.2f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    whole, cone = table.records()[:2]
    printed = "the catalogue's, printed to three digits, of another grid of samples"
    return (
        Check("largest error on the square, of 0.25: deviation", abs(whole["largest"] - 0.25), "<=", 1e-4,
              "ideal", "sqrt(a) - a is largest where a = 1/4; a grid of 401 passes it closely"),
        Check("largest error on the cone, of 0.25: deviation", abs(cone["largest"] - 0.25), "<=", 1e-4,
              "ideal", "the same, along the cone"),
        Check("(v.t)^2 of the largest error on the cone, of 0.5: deviation",
              abs(cone["there |v.t|"] ** 2 - 0.5), "<=", 0.01, "ideal", "the grid's step is 0.005"),
        Check("RMS on the square, of 0.168: relative deviation", abs(whole["RMS"] / 0.168 - 1.0), "<=", 0.01,
              "ideal", printed),
        Check("mean on the square, of -0.144: relative deviation", abs(whole["mean"] / -0.144 - 1.0), "<=",
              0.01, "ideal", printed),
    )  # fmt: skip


def plot(axes, table):
    """The error over the square, and both brackets along the cone."""
    square, cone = axes
    picture = square.imshow(
        table.curves["error"], origin="lower", extent=(-1, 1, -1, 1), cmap="YlOrBr_r", vmin=-0.25, vmax=0.0
    )
    square.grid(False)
    square.plot([-1, 1], [1, -1], color="black", linestyle=":", linewidth=1)
    square.set_xlabel("v.t")
    square.set_ylabel("l.t")
    square.figure.colorbar(picture, ax=square, label="bracket with R* minus with R", shrink=0.85)
    cone.plot(
        table.curves["v.t"], table.curves["R"], color=ORANGE, linestyle="--", label="R(s) = sqrt(1 - s)"
    )
    cone.plot(table.curves["v.t"], table.curves["R*"], color=BLUE, label="R*(s) = 1 - s")
    half = 0.5**0.5
    cone.plot([-half, half], [0.75, 0.75], label="catalogue: 0.75 at (v.t)^2 = 0.5", **EXPECTED)
    cone.set_xlabel("v.t on the cone l.t = -v.t (dotted on the left)")
    cone.set_ylabel("Banks' bracket")
    cone.set_ylim(0.0, 1.05)
    cone.legend(loc="lower center")


STUDY = Study(
    id="P17",
    title="R*(s) = 1 - s in the place of sqrt(1 - s)",
    question="What does Banks' model lose without its square root?",
    method=f"Both brackets in float64 at {_SAMPLES} x {_SAMPLES} points of the square of v.t and l.t.",
    source="KautzSeidel2000",
    techniques=("K03", "K04"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
