"""P17: Banks' model with R*(s) = 1 - s instead of the square root.

Source: Kautz, Seidel 2000, section 3.1 (artefact P17 of the catalogue).
"""

from dataclasses import dataclass

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.views import Panel, orthographic_view
from fixedpipe.effects.reflectance import banks_without_lookup, material_textures
from fixedpipe.effects.reflectance.brdfs import banks_bracket, banks_r_approximate
from fixedpipe.effects.studies.shared.strips import drawn
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, RED, Column, Study, Table

DATA = study_data(__file__, "P17")

# Samples along either axis of the square of v.t and l.t; odd, so that the middle of an edge is one.
_SAMPLES = 401
# Cells of the square that the machine draws, a pixel each.
_CELLS = 64


@dataclass(frozen=True, eq=False)
class _Given:
    """Vectors [n, 3], one for every vertex, which replace a light or an eye."""

    vectors: np.ndarray
    panel = Panel(0, 0, _CELLS, _CELLS)
    vertex = orthographic_view(panel).vertex

    def light_vectors(self, _):
        return self.vectors

    def view_vectors(self, _):
        return self.vectors


def on_machine(profile):
    """The bracket that K04's passes leave for _CELLS x _CELLS pairs of v.t and l.t, and both dot products:
    float64 [_CELLS, _CELLS] each.

    t is +x. The last pass, which multiplies by k_s (n.l)+, is omitted.
    """
    axis = (np.arange(_CELLS) + 0.5) * (2.0 / _CELLS) - 1.0
    view, light = np.meshgrid(axis, axis)
    places = np.arange(_CELLS) * (2.0 / _CELLS) - 1.0
    x, y = (a.ravel()[:, None] for a in np.meshgrid(places, places))
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * (2.0 / _CELLS)
    count = 4 * _CELLS * _CELLS
    positions = np.stack([(x + corner[:, 0]).ravel(), (y + corner[:, 1]).ravel(), np.zeros(count)], axis=-1)
    frame = [np.tile(row, (count, 1)) for row in np.eye(3)]
    first = 4 * np.arange(_CELLS * _CELLS)[:, None]
    triangles = np.concatenate([first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1)
    surface = Surface(
        positions, frame[2], frame[0], frame[1], np.full((count, 2), 0.5), triangles.reshape(-1, 3)
    )

    def leaning(products):
        """Unit vectors whose dot products with +x are these, at every cell's four corners."""
        flat = np.repeat(products.ravel(), 4)
        return np.stack([flat, 0.0 * flat, np.sqrt(1.0 - flat * flat)], axis=-1)

    loading, names = banks_without_lookup.load(material_textures.isotropic(1, 1, 1.0), "flat", profile)
    eye = _Given(leaning(view))
    passes = banks_without_lookup.specular_passes(surface, names, eye, _Given(leaning(light)), profile)
    commands = (eye.panel.clear((0.0, 0.0, 0.0)), *loading, *passes[:-1])
    return drawn(commands, profile, _CELLS, _CELLS)[..., 0], view, light


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


def _row(name, found, view, light):
    """A row: ``found`` compared with the exact bracket, and with the bracket by R*."""
    error = found - banks_bracket(view, light)
    worst = int(np.abs(error).argmax())
    return (
        name,
        root_mean_square(error),
        float(error.mean()),
        float(np.abs(error).max()),
        abs(float(view.flat[worst])),
        abs(float(light.flat[worst])),
        root_mean_square(found - banks_bracket(view, light, banks_r_approximate)),
    )


def measure(profile):
    """The table, with a row for each part of the square in float64, and one for the machine."""
    rows = [
        _row(name, banks_bracket(view, light, banks_r_approximate), view, light)
        for name, (view, light) in _regions(_SAMPLES).items()
    ]
    rows.append(_row("the machine's passes", *on_machine(profile)))
    columns = (
        Column("where"),
        Column("RMS", form=".4f"),
        Column("mean", form=".4f"),
        Column("largest", form=".4f"),
        Column("there |v.t|", form=".3f"),
        Column("there |l.t|", form=".3f"),
        Column("RMS to R*", form=".4f"),
    )
    axis = np.arange(_SAMPLES) * (2.0 / (_SAMPLES - 1)) - 1.0
    view, light = np.meshgrid(axis, axis)
    curves = {
        "error": banks_bracket(view, light, banks_r_approximate) - banks_bracket(view, light),
        "v.t": axis,
        "R": banks_bracket(axis, -axis),
        "R*": banks_bracket(axis, -axis, banks_r_approximate),
    }
    found, view, light = on_machine(profile)
    # The cells of the cone l.t = -v.t run from the upper left to the lower right.
    curves["v.t of cells"], curves["machine"] = view[0], found[::-1].diagonal()
    return Table(columns, tuple(rows), curves)


def findings(table):
    """How much is lost, and where."""
    whole, cone, *_, machine = table.records()
    return (
        f"R* makes Banks' bracket darker by {-whole['mean']:.3f} in the mean over the square of v.t and "
        f"l.t, with an RMS of {whole['RMS']:.3f}.",
        f"On the cone of mirror directions the bracket is 1. There R* loses up to {cone['largest']:.3f}, at "
        f"(v.t)^2 = {cone['there |v.t|'] ** 2:.2f}. The passes of K04 on the machine are within an RMS of "
        f"{machine['RMS to R*']:.4f} of R*. From the exact bracket they are {machine['RMS']:.4f}.",
    )


def checks(table):
    """The catalogue's numbers."""
    whole, cone, *_, machine = table.records()
    return (
        DATA.check(
            "largest error on the square, of 0.25: deviation", abs(whole["largest"] - 0.25), Answer.IDEAL
        ),
        DATA.check(
            "largest error on the cone, of 0.25: deviation", abs(cone["largest"] - 0.25), Answer.IDEAL
        ),
        DATA.check(
            "(v.t)^2 of the largest error on the cone, of 0.5: deviation",
            abs(cone["there |v.t|"] ** 2 - 0.5),
            Answer.IDEAL,
        ),
        DATA.check(
            "RMS on the square, of 0.168: relative deviation", abs(whole["RMS"] / 0.168 - 1.0), Answer.IDEAL
        ),
        DATA.check(
            "mean on the square, of -0.144: relative deviation",
            abs(whole["mean"] / -0.144 - 1.0),
            Answer.IDEAL,
        ),
        DATA.check("RMS of the machine's passes against R*", machine["RMS to R*"], Answer.MACHINE),
        DATA.check(
            "RMS of the machine's passes against the exact bracket, of 0.168: relative deviation",
            abs(machine["RMS"] / 0.168 - 1.0),
            Answer.MACHINE,
        ),
    )


def plot(axes, table):
    """The error over the square of v.t and l.t, and both brackets along the cone."""
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
    cone.plot(table.curves["v.t of cells"], table.curves["machine"], ".", color=RED, label="machine (K04)")
    cone.plot([-half, half], [0.75, 0.75], label="catalogue: 0.75 at (v.t)^2 = 0.5", **EXPECTED)
    cone.set_xlabel("v.t on the cone l.t = -v.t (dotted on the left)")
    cone.set_ylabel("Banks' bracket")
    cone.set_ylim(0.0, 1.05)
    cone.legend(loc="lower center")


STUDY = Study(
    **DATA.words,
    method=(
        f"Both brackets in float64 at {_SAMPLES} x {_SAMPLES} points of the square of v.t and l.t, and what "
        f"the passes of K04 leave of {_CELLS} x {_CELLS}."
    ),
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
