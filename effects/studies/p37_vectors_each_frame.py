"""P37: vectors that the host computes for every frame, compared with lists that the board stores.

Source: Kautz, Seidel 2000, section 5.1 (artefact P37 of the catalogue).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.studies.shared.traffic import FLOAT, counted, vertex_arrays
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import Draw

DATA = study_data(__file__, "P37")

# Slices and stacks of F004-4's spheres; 50 and 26 are the paper's 2500 triangles each.
TESSELLATIONS = ((26, 14), (36, 19), (50, 26), (70, 37), (100, 51))
PAPER = (50, 26)
# Operations on floats for a vector at a vertex.  Source: fixedpipe.effects.geometry.vectors.in_frame, three
# dot products of 3 multiplications and 2 additions; fixedpipe.effects.passes.encoding.vector_texels, 3
# multiplications and 3 additions.
_OPERATIONS = 3 * 5 + 3 * 2
# A vertex program is given the matrix and one vector; at the vertices it reads the local frame as well.
_PROGRAM_PARAMETERS, _LOCAL_FRAME = (4 * 4 + 4) * FLOAT, 9 * FLOAT
# Source: Kautz, Seidel 2000, section 6: 15 to 25 frames a second.
_HERTZ = 20
_WAYS = ("nothing moves", "all sent again", "colours sent again", "vertex program")


def frame(profile, slices, stacks):
    """The bytes of F004-4's frame if the light moves (``traffic.counted``), and its "triangles", "vectors"
    (those that the CPU computes at vertices) and "geometry" (bytes of all vertex arrays).
    """
    figure = FIGURES["F004-4"]
    shape = {"slices": slices, "stacks": stacks}
    first = figure.commands(profile, 64, **shape)
    out = counted(first, figure.commands(profile, 64, **shape, light=(0.30, 0.40, 0.87)))
    draws = [command for command in first if isinstance(command, Draw)]
    out["triangles"] = sum(len(draw.mesh.indices) // 3 for draw in draws)
    out["vectors"] = sum(len(draw.mesh.colors) for draw in draws)
    out["geometry"] = sum(size for draw in draws for _, size in vertex_arrays(draw).values())
    return out


def _textures(count):
    """Bytes of the frame's textures, which the board keeps."""
    return count["kept"] - (count["geometry"] - count["vertices"])


def _ways(count):
    """(operations, bytes before the first frame, bytes in each frame) for each of ``_WAYS``."""
    operations = count["vectors"] * _OPERATIONS
    return (
        (0, count["kept"] + count["vertices"], 0),
        (operations, _textures(count), count["geometry"]),
        (operations, count["kept"], count["vertices"]),
        (0, count["kept"] + count["vectors"] * _LOCAL_FRAME, count["passes"] * _PROGRAM_PARAMETERS),
    )


def measure(profile):
    """The table, with a row for each way to keep the vectors up to date, at the paper's tessellation."""
    counts = {shape: frame(profile, *shape) for shape in TESSELLATIONS}
    rows = tuple(
        (
            name,
            operations,
            start / 1024.0,
            each / 1024.0,
            each * _HERTZ / 1e6,
        )
        for name, (operations, start, each) in zip(_WAYS, _ways(counts[PAPER]), strict=True)
    )
    columns = (
        Column("vectors"),
        Column("CPU operations a frame", form=",d"),
        Column("before the first frame", "KB", ".1f"),
        Column("each frame", "KB", ".2f"),
        Column("at 20 Hz", "MB/s", ".3f"),
    )
    curves = {"triangles": np.array([c["triangles"] for c in counts.values()], np.float64)}
    for k, name in enumerate(_WAYS):
        curves[name] = np.array([_ways(c)[k][2] for c in counts.values()], np.float64)
    curves["textures"] = np.array([_textures(c) for c in counts.values()], np.float64)
    return Table(columns, rows, curves)


def findings(table):
    """How many bytes each way moves."""
    still, everything, colors, program = table.records()
    share = colors["each frame"] / everything["each frame"]
    triangles = int(table.curves["triangles"][TESSELLATIONS.index(PAPER)])
    return (
        f"With a moving light, the two passes over {triangles // 2} triangles send "
        f"{everything['each frame']:.1f} KB a frame, and the CPU does "
        f"{everything['CPU operations a frame']:,d} operations. A display list that nothing changes sends "
        f"{still['each frame']:.0f} KB.",
        f"Only the colours change, {100 * share:.0f} % of the data. A vertex program of a later board takes "
        f"{program['each frame']:.2f} KB a frame, and no vector from the CPU.",
    )


def checks(table):
    """The catalogue's claims about the ways."""
    still, everything, colors, program = table.records()
    share = colors["each frame"] / everything["each frame"]
    arrays = "4 bytes a vertex of 24 and 6 a triangle, of which there are 1.8 a vertex: 0.115"
    growth = table.curves["all sent again"] / table.curves["triangles"]
    return (
        DATA.check("bytes a frame of a static list", still["each frame"], Answer.MACHINE),
        DATA.check("bytes a frame, colours sent again / all sent again", share, Answer.MACHINE),
        Check(
            "bytes a frame, colours sent again / all sent again",
            share,
            at_least=0.05,
            on=Answer.MACHINE,
            reason=arrays,
        ),
        DATA.check(
            "bytes a frame, vertex program / all sent again",
            program["each frame"] / everything["each frame"],
            Answer.MACHINE,
        ),
        DATA.check(
            "CPU operations of a vertex program", float(program["CPU operations a frame"]), Answer.MACHINE
        ),
        DATA.check(
            "bytes per triangle, finest / coarsest spheres", float(growth[-1] / growth[0]), Answer.MACHINE
        ),
    )


def plot(axes, table):
    """Bytes in each frame by number of triangles."""
    (ax,) = axes
    triangles = table.curves["triangles"]
    for name, color, marker in (
        ("all sent again", RED, "o"),
        ("colours sent again", ORANGE, "s"),
        ("vertex program", GREEN, "^"),
    ):
        ax.loglog(triangles, table.curves[name] / 1024.0, color=color, marker=marker, label=name)
    once = table.curves["textures"] / 1024.0
    ax.loglog(triangles, once, color=BLUE, linestyle="--", label="material textures, once")
    ax.axvline(
        triangles[TESSELLATIONS.index(PAPER)], color="black", linestyle=":", label="the paper's spheres"
    )
    ax.set_xlabel("triangles drawn in a frame, both passes and both spheres")
    ax.set_ylabel("KB from host to board in each frame (a static list: none)")
    ax.set_ylim(0.1, 1e5)
    ax.set_xticks(triangles, [f"{int(count):,d}" for count in triangles])
    ax.minorticks_off()
    ax.legend(loc="upper left", ncols=2)


STUDY = Study(
    **DATA.words,
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
