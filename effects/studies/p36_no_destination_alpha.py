"""P36: windows without destination alpha.

H36 draws depths into the window's alpha, and H38 compares them there. A surface without alpha stores none; a
read returns some other value. The study draws the same passes there nevertheless, to show why they are
refused. H37 with its ramp in red instead (``Coding``'s component) needs no alpha.

Five bits are at the top of a byte, with zeros below (``framebuffers.framebuffer``). Where nothing is drawn,
the map has ones, which are read as 248 of 255. Farther points are behind everything that the map can hold. So
the table separates the pixels at this depth.

Source: Heidrich 2001, section 2.1 (artefact P36 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.objects_and_lamps import lamp_around
from fixedpipe.effects.scenes.still_life import still_life, still_life_view
from fixedpipe.effects.shadows import alpha_coded_shadows as alpha
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import MakeCurrent
from fixedpipe.pipeline.enums import ColorFormat
from fixedpipe.pipeline.execution.machine import execute

DATA = study_data(__file__, "P36")

# Formats, how many bits of alpha each has, and how many bits of red a depth can have instead.
FORMATS = (
    ("A8R8G8B8", ColorFormat.A8R8G8B8, 8, 8),
    ("X8R8G8B8, zeros", ColorFormat.X8R8G8B8_Z8R8G8B8, 0, 8),
    ("X8R8G8B8, ones", ColorFormat.X8R8G8B8_O8R8G8B8, 0, 8),
    ("R5G6B5", ColorFormat.R5G6B5, 0, 5),
)
_SIZE, _LAMP = 128, (-6.4, 6.6, 1.0)
# In all, of 8 bits; a step of 5 bits is more than that alone.
_BIAS = {8: 2.0, 5: 1.0}


def lit_and_map(profile, color_format, way, *, component=alpha.DepthComponent.ALPHA, bits=8, alpha_bits=8):
    """(pixels of the still life that the machine lights on a surface of a format, bool [128, 128], bottom row
    first; the map's largest number, 1 = the lamp's far plane).

    Raises ValueError as ``alpha_coded_shadows`` does, if a way needs alpha and ``alpha_bits`` is 0.
    """
    scene, view, lamp = _scene()
    panel, coding = view.panel, alpha.Coding(bits, bias=_BIAS[bits], component=component)
    settings = {"alpha_bits": alpha_bits} if way is alpha.with_one_unit else {}
    commands = (
        MakeCurrent(
            label="a surface of its own", surface="window", width=_SIZE, height=_SIZE,
            color_format=color_format,
        ),
        coding.ramp(profile),
        *alpha.store_map(scene, lamp, panel, _SIZE, profile, coding, shading=SceneShading.MASK),
        *way(
            scene, view, lamp, profile, coding,
            background=(0.0, 0.0, 0.0), shading=SceneShading.MASK, **settings,
        ),
    )  # fmt: skip
    drawn = execute(commands, profile, _SIZE, _SIZE)
    stored = drawn.textures[alpha.MAP].levels[0][0, ..., 3]
    return drawn.surfaces["window"].color[::-1, :, 0] > 127, float(stored.max()) / 255.0


def lit(profile, color_format, way, **settings):
    """The lit pixels of ``lit_and_map``."""
    return lit_and_map(profile, color_format, way, **settings)[0]


def _scene():
    """The still life, its view and its lamp."""
    scene = still_life(24)
    return scene, still_life_view(Panel(0, 0, _SIZE, _SIZE)), lamp_around(scene, _LAMP)


def depths():
    """The distance from the lamp to the point that each pixel shows, by rays, 1 = the far plane: float64
    [128, 128], bottom row first.
    """
    scene, view, lamp = _scene()
    plane = np.array(lamp.depth_plane)
    return ray_caster.visible(ray_caster.scene_caster(scene), view).points @ plane[:3] + plane[3]


def refused(profile, color_format, alpha_bits):
    """Whether ``alpha_coded_shadows`` refuses H38 for a window with ``alpha_bits`` bits of alpha."""
    try:
        lit(profile, color_format, alpha.with_one_unit, alpha_bits=alpha_bits)
    except ValueError:
        return True
    return False


def measure(profile):
    """The table, with a row for each format."""
    whole, depth = lit(profile, ColorFormat.A8R8G8B8, alpha.with_combiners), depths()
    rows = []
    for name, color_format, alpha_bits, red_bits in FORMATS:

        def light(way, color_format=color_format, **settings):
            return 100.0 * float(lit(profile, color_format, way, **settings).sum() / whole.sum())

        through_red, farthest = lit_and_map(
            profile, color_format, alpha.with_combiners, component=alpha.DepthComponent.RED, bits=red_bits
        )
        held = depth <= farthest
        rows.append(
            (
                name,
                alpha_bits,
                "yes" if refused(profile, color_format, alpha_bits) else "no",
                light(alpha.with_one_unit),
                light(alpha.with_combiners),
                100.0 * float(through_red.sum() / whole.sum()),
                100.0 * farthest,
                100.0 * float((through_red == whole)[held].mean()),
                100.0 * float((through_red & whole)[~held].sum() / whole[~held].sum()),
            )
        )
    columns = (
        Column("colours"),
        Column("bits of alpha", form="d"),
        Column("H38 refused"),
        Column("H38 lights", "%", ".1f"),
        Column("H37 lights", "%", ".1f"),
        Column("H37 by red lights", "%", ".1f"),
        Column("map ends", "%", ".1f"),
        Column("nearer agree", "%", ".1f"),
        Column("farther lit", "%", ".1f"),
    )
    return Table(columns, tuple(rows))


def findings(table):
    """Which ways the machine refuses, what it would draw with them, and which ways still run."""
    row = {r["colours"]: r for r in table.records()}
    without = [r for r in table.records() if not r["bits of alpha"]]
    zeros, ones, short = row["X8R8G8B8, zeros"], row["X8R8G8B8, ones"], row["R5G6B5"]
    return (
        f"H38 is refused on {sum(r['H38 refused'] == 'yes' for r in without)} of {len(without)} formats "
        f"without alpha. Drawn all the same, it would light {zeros['H38 lights']:.0f}, "
        f"{ones['H38 lights']:.0f} and {short['H38 lights']:.0f} % of what it should. Destination alpha "
        "reads as one there.",
        f"H37 with a map in alpha would light {zeros['H37 lights']:.0f} % where the surface's padding is "
        f"zeros, and {ones['H37 lights']:.0f} % where it is ones. It reads the nearest depth everywhere, or "
        "the farthest.",
        f"With the depth in red H37 runs: {zeros['nearer agree']:.1f} and {ones['nearer agree']:.1f} % of "
        f"the pixels are those of a window with alpha. With five bits of red {short['nearer agree']:.1f} % "
        "are, of the pixels that are no farther than the map holds.",
        f"A map of five bits ends at {short['map ends']:.1f} % of the far plane's depth, because its ones "
        "are 248 of 255. A window with alpha lights the ground beyond. The map of five bits lights "
        f"{short['farther lit']:.1f} % of it, and eight bits of red {zeros['farther lit']:.1f} %.",
    )


def checks(table):
    """Which ways must be refused, and which must run."""
    for r in table.records():
        name = r["colours"]
        yield DATA.check(
            "{name}: H38 refused where there is no alpha, and nowhere else",
            float((r["H38 refused"] == "yes") == (r["bits of alpha"] == 0)),
            Answer.MACHINE,
            name=name,
        )
        if r["bits of alpha"]:
            yield DATA.check(
                "{name}: light of H38 over H37's, deviation, %",
                abs(r["H38 lights"] - 100.0),
                Answer.MACHINE,
                name=name,
            )
        else:
            wrong = min(abs(r[f"{h} lights"] - 100.0) for h in ("H37", "H38"))
            yield DATA.check(
                "{name}: how far H37 and H38 by alpha are off, %", wrong, Answer.MACHINE, name=name
            )
        short = "R5" in name
        bound, reason = 100.0, "the catalogue's: H37 still runs; red has as many bits"
        if short:
            bound = 95.0
            reason = (
                "a bias of one step of five bits is that of eight steps of eight; measured at the first "
                "correct table"
            )
        yield Check(
            f"{name}: pixels no farther than the map holds that are those of a window with alpha, %",
            r["nearer agree"],
            at_least=bound,
            on=Answer.MACHINE,
            reason=reason,
        )
        end = 100.0 * 248.0 / 255.0 if short else 100.0
        yield DATA.check(
            "{name}: how far the end of a map in red is from {end:.1f} % of the far plane's depth",
            abs(r["map ends"] - end),
            Answer.MACHINE,
            name=name,
            end=end,
        )
        bound = {"at_most": 1.0} if short else {"at_least": 100.0}
        yield Check(
            f"{name}: light beyond the map's end, % of a window's with alpha",
            r["farther lit"],
            on=Answer.MACHINE,
            **bound,
            reason="the ramp goes on to 255 there; what is within half a step of 248 is lit"
            if short
            else "where nothing is drawn the map is as far as the ramp goes",
        )


def plot(axes, table):
    """The share of lit pixels of each way, by format."""
    (axis,) = axes
    names, shown = table.column("colours"), (("H38", BLUE), ("H37", ORANGE), ("H37 by red", GREEN))
    for k, (name, color) in enumerate(shown):
        places = np.arange(len(names)) + 0.27 * (k - 1)
        axis.bar(places, table.column(f"{name} lights"), 0.25, color=color, label=name)
    axis.axhline(100.0, color="black", linewidth=0.8)
    axis.set_xticks(np.arange(len(names)), names)
    axis.set_ylabel("light, % of the right picture's")
    axis.legend()


STUDY = Study(
    **DATA.words,
    method=(
        f"The still life, {_SIZE} x {_SIZE} pixels, on surfaces of formats with and without alpha: H38 and "
        "H37 as they are, and H37 with its depth in red; lit pixels, of those in a window with alpha. "
        "Rays say which are farther from the lamp than the map's largest number."
    ),
    machines=("NV2A", "GEFORCE_3"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
