"""P37: vectors that the host computes for every frame, beside lists that the board keeps.

Source: Kautz, Seidel 2000, section 5.1 (artefact P37 of the catalogue).
"""

import numpy as np

from effects.figures import FIGURES, Check
from effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table
from pipeline.commands import Draw, TexImage

# Slices and stacks of F004-4's spheres; 50 and 26 are the paper's 2500 triangles each.
TESSELLATIONS = ((26, 14), (36, 19), (50, 26), (70, 37), (100, 51))
PAPER = (50, 26)
# Bytes that OpenGL 1.2.1's vertex arrays hold: floats for positions and texture coordinates, unsigned bytes
# for colours, padded to four; unsigned shorts for indices.
_FLOAT, _COLOR, _INDEX = 4, 4, 2
# Operations on floats for a vector at a vertex.  Source: effects.vectors.in_frame, three dot products of 3
# multiplications and 2 additions; effects.encode.encode_expand, 3 multiplications and 3 additions.
_OPERATIONS = 3 * 5 + 3 * 2
# A vertex program is given the matrix and one vector; at the vertices it reads the local frame as well.
_PROGRAM_PARAMETERS, _FRAME = (4 * 4 + 4) * _FLOAT, 9 * _FLOAT
# Source: Kautz, Seidel 2000, section 6: 15 to 25 frames a second.
_HERTZ = 20
_WAYS = ("nothing moves", "all sent again", "colours sent again", "vertex program")


def _arrays(draw):
    """The arrays of a Draw that are sent, with their bytes: {name: (array, bytes)}."""
    mesh, units = draw.mesh, draw.state.texture_units
    sent = {
        "positions": (mesh.positions, mesh.positions.size * _FLOAT),
        "indices": (mesh.indices, mesh.indices.size * _INDEX),
        "colors": (mesh.colors, len(mesh.colors) * _COLOR),
    }
    for k in sorted({unit.coordinates for unit in units}):
        coordinates = mesh.texture_coordinates[k]
        sent[f"texture coordinates {k}"] = (coordinates, coordinates.size * _FLOAT)
    return sent


def counted(profile, slices, stacks):
    """Bytes and operations of F004-4's frame, from the commands of two frames between which the light moves.

    Returns a dict: "triangles", "vectors" (at vertices), "geometry" (bytes of all arrays), "changed" (bytes
    of those that differ between the frames), "draws", "textures" (bytes, which the board keeps).
    """
    figure = FIGURES["F004-4"]
    shape = {"slices": slices, "stacks": stacks}
    first = figure.commands(profile, 64, **shape)
    second = figure.commands(profile, 64, **shape, light=(0.30, 0.40, 0.87))
    out = dict.fromkeys(("triangles", "vectors", "geometry", "changed", "draws", "textures"), 0)
    for before, after in zip(first, second, strict=True):
        if isinstance(before, TexImage):
            out["textures"] += sum(level.nbytes for level in before.image.levels)
        if not isinstance(before, Draw):
            continue
        arrays, moved = _arrays(before), _arrays(after)
        out["draws"] += 1
        out["triangles"] += len(before.mesh.indices) // 3
        for name, (array, size) in arrays.items():
            out["geometry"] += size
            if not np.array_equal(array, moved[name][0]):
                out["changed"] += size
                out["vectors"] += len(array)
    return out


def _ways(count, vertices):
    """(operations, bytes before the first frame, bytes in each frame) for each of ``_WAYS``."""
    kept = count["textures"]
    return (
        (0, kept + count["geometry"], 0),
        (count["vectors"] * _OPERATIONS, kept, count["geometry"]),
        (count["vectors"] * _OPERATIONS, kept + count["geometry"] - count["changed"], count["changed"]),
        (0, kept + count["geometry"] - count["changed"] + vertices * _FRAME,
         count["draws"] * _PROGRAM_PARAMETERS),
    )  # fmt: skip


def measure(profile):
    """A row for each way to keep the vectors up to date, at the paper's tessellation."""
    counts = {shape: counted(profile, *shape) for shape in TESSELLATIONS}
    rows = tuple(
        (
            name,
            operations,
            start / 1024.0,
            frame / 1024.0,
            frame * _HERTZ / 1e6,
        )
        for name, (operations, start, frame) in zip(
            _WAYS, _ways(counts[PAPER], counts[PAPER]["vectors"]), strict=True
        )
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
        curves[name] = np.array([_ways(c, c["vectors"])[k][2] for c in counts.values()], np.float64)
    curves["textures"] = np.array([c["textures"] for c in counts.values()], np.float64)
    return Table(columns, rows, curves)


def findings(table):
    """The traffic of each way."""
    still, everything, colors, program = table.records()
    ratio = everything["each frame"] / colors["each frame"]
    triangles = int(table.curves["triangles"][TESSELLATIONS.index(PAPER)])
    return (
        f"With a moving light the two passes over {triangles // 2} triangles "
        f"send {everything['each frame']:.1f} KB a frame and the CPU does "
        f"{everything['CPU operations a frame']:,d} operations; a list that nothing changes sends {still['each frame']:.0f}.",
        f"Only the colours change, {100 / ratio:.0f} % of it. A vertex program of a later board takes "
        f"{program['each frame']:.2f} KB a frame and no vector from the CPU.",
    )


def checks(table):
    """What the catalogue claims of the ways."""
    still, everything, colors, program = table.records()
    growth = table.curves["all sent again"] / table.curves["triangles"]
    return (
        Check("bytes a frame of a static list", still["each frame"], "<=", 0.0, "machine",
              "the catalogue's: the board keeps what does not change"),
        Check("bytes a frame, all sent again / colours sent again",
              everything["each frame"] / colors["each frame"], ">=", 4.0, "machine",
              "24 bytes a vertex and 6 a triangle beside 4 a vertex: (24 + 6 x 1.8) / 4 = 8.7"),
        Check("bytes a frame, vertex program / all sent again",
              program["each frame"] / everything["each frame"], "<=", 0.01, "machine",
              "the catalogue's: a vertex program removes it"),
        Check("CPU operations of a vertex program", float(program["CPU operations a frame"]), "<=", 0.0,
              "machine", "likewise"),
        Check("bytes per triangle, finest / coarsest spheres", float(growth[-1] / growth[0]), ">=", 0.9,
              "machine", "the traffic grows with the triangles; a sphere's seam is a smaller part of many"),
    )  # fmt: skip


def plot(axes, table):
    """Bytes a frame by triangles."""
    (ax,) = axes
    triangles = table.curves["triangles"]
    for name, color, marker in (
        ("all sent again", RED, "o"),
        ("colours sent again", ORANGE, "s"),
        ("vertex program", GREEN, "^"),
    ):
        ax.loglog(triangles, table.curves[name] / 1024.0, color=color, marker=marker, label=name)
    ax.loglog(
        triangles, table.curves["textures"] / 1024.0, color=BLUE, linestyle="--",
        label="material textures, once",
    )  # fmt: skip
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
    id="P37",
    title="Vectors recomputed for every frame",
    question="What does it cost that a moving light changes the vectors of every vertex?",
    method=(
        "Bytes of the arrays in F004-4's commands, of two frames between which the light moves, as vertex "
        "arrays hold them; and operations on floats for the vectors that differ."
    ),
    source="KautzSeidel2000",
    techniques=("K07", "K10", "K17"),
    machines=("GEFORCE_256", "GEFORCE_3", "NV2A"),
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
