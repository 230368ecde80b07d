"""P30: the document's bytes of normals, and the parts of machines that read them.

Source: Zwicker 2016, "Storing bump maps" (artefact P30 of the catalogue).
"""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.bump_mapping import normal_maps
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import vectors
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.passes.combiners import (
    ONE,
    PRIMARY,
    SPARE0,
    TEXTURE0,
    TEXTURE2,
    dot,
    expand,
    negated,
    product,
    program,
    scaled,
    shown,
    signed,
)
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.studies.shared.random_frames import random_directions
from fixedpipe.effects.studies.shared.strips import drawn, strip
from fixedpipe.effects.studies.study import BLUE, EXPECTED, ORANGE, Column, Study, Table
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import DotProductMapping
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.state import (
    PassState,
    TextureShaderStage,
    TextureUnit,
)
from fixedpipe.pipeline.textures.images import texture_2d

DATA = study_data(__file__, "P30")

# The document's bytes, and those of a program that cuts off instead of rounding.
ROUNDINGS = {"rounded": normal_maps.encode, "cut off": lambda v: np.floor((v + 1.0) / 2.0 * 255.0)}
# What reads them: a fragment program, real numbers; combiners, 2n - 256; a texture shader's dot products,
# (n - 128)/127.
READERS = ("fragment program", "combiners", "dot products")
_NORMALS = 20000
# A light so many degrees above the plane, of whose brightness a lean takes or adds a part.
GRAZING = 10.0


def _axes_combiners(factor, half):
    """Combiners that show the positive part of n.axis times ``factor``, or of its negative: ``half`` is
    ``signed`` or ``negated``. The axis is the primary colour.
    """
    return program(
        scaled(factor, dot(expand(TEXTURE0), expand(PRIMARY), to=SPARE0)),
        product(half(SPARE0), ONE, to=SPARE0),
        shown(SPARE0),
    )


def _loaded(stored):
    return TexImage(label="a flat texel", texture="flat", image=texture_2d(stored.reshape(1, 1, 3)))


def _by_combiners(stored, profile):
    """(x, y, z) of a flat texel as combiners read it. They show 4 x and 4 y, which are divided by 4 again."""
    out = []
    for axis, factor in ((0, 4.0), (1, 4.0), (2, 1.0)):
        color = 0.5 + 0.5 * np.eye(3)[axis]
        if not profile.arithmetic.exact:
            color = np.where(color == 0.5, 128.0 / 255.0, color)
        mesh = strip(1, color[None], np.full((1, 2), 0.5))
        value = 0.0
        for sign, half in ((1.0, signed), (-1.0, negated)):
            state = PassState(
                texture_units=(TextureUnit("flat", NEAREST),),
                register_combiners=_axes_combiners(factor, half),
            )
            commands = (_loaded(stored), Draw(label="n.axis", mesh=mesh, state=state))
            value += sign * float(_picture(commands, profile)[4, 4, 0])
        out.append(value / factor)
    return np.array(out)


def _picture(commands, profile):
    if profile.arithmetic.exact:
        return execute_ideal(commands, 8, 8).color[::-1, :, :3]
    return drawn(commands, profile, 8, 8)


# x and y are looked up so many times enlarged, from the middle of a table of 256 x 256 places.
_ENLARGED, _PLACES = 32.0, 256


def _by_dot_products(stored, profile):
    """(x, y, z) of a flat texel as two dot products of a texture shader read it. x and y come from the place
    in a table that they look up, and z from their mapping of the byte.
    """
    place = np.arange(_PLACES, dtype=np.uint8)
    s, t = np.meshgrid(place, place)
    table = texture_2d(np.stack([s, t, 0 * s], axis=-1))
    # (s, t, r) . (x, y, z) = 1/2 + 32 x, as z is nearly one.
    rows = np.array([(_ENLARGED, 0.0, 0.5), (0.0, _ENLARGED, 0.5)])
    corners = np.tile(np.array([0.5, 0.5]), (4, 1))
    mesh = strip(1, None, corners[:1])
    coordinates = (mesh.texture_coordinates[0], *(np.tile(row, (4, 1)) for row in rows))
    mesh = type(mesh)(mesh.positions, mesh.primitive, texture_coordinates=coordinates)
    normal = DotProductMapping.EXPAND_NORMAL
    state = PassState(
        texture_units=(
            TextureUnit("flat", NEAREST),
            TextureUnit(None, coordinates=1),
            TextureUnit("table", NEAREST, coordinates=2),
        ),
        texture_shader=(
            TextureShaderStage(Operation.TEXTURE_2D),
            TextureShaderStage(Operation.DOT_PRODUCT, 0, dot_product_mapping=normal),
            TextureShaderStage(Operation.DOT_PRODUCT_TEXTURE_2D, 0, dot_product_mapping=normal),
        ),
        register_combiners=program(shown(TEXTURE2)),
    )
    commands = (
        _loaded(stored),
        TexImage(label="a table of places", texture="table", image=table),
        Draw(label="two dot products", mesh=mesh, state=state),
    )
    seen = 255.0 * drawn(commands, profile, 8, 8)[4, 4]
    x, y = ((float(c) + 0.5) / _PLACES / _ENLARGED - 0.5 / _ENLARGED for c in seen[:2])
    return np.array([x, y, (float(stored[2]) - 128.0) / 127.0])


def _decoded(stored, reader):
    """The numbers that a reader makes of bytes, float64 of the same shape."""
    stored = np.asarray(stored, np.float64)
    if reader == "fragment program":
        return normal_maps.decode(stored)
    return (2.0 * stored - 256.0) / 255.0 if reader == "combiners" else (stored - 128.0) / 127.0


def _lean(vector):
    x, y, z = normalize(vector)
    return math.degrees(math.atan2(math.hypot(x, y), z))


def measure(profile):
    """The table, with a row for each reader and each way of making bytes."""
    rows = []
    directions = random_directions(_NORMALS, 30)
    directions[:, 2] = np.abs(directions[:, 2])
    flat = np.array([0.0, 0.0, 1.0])
    for reader in READERS:
        for rounding, encode in ROUNDINGS.items():
            stored = encode(flat).astype(np.uint8)
            if reader == "dot products":
                read = _by_dot_products(stored, profile)
            else:
                read = _by_combiners(stored, IDEAL if reader == "fragment program" else profile)
            found = normalize(_decoded(encode(directions), reader))
            errors = np.degrees(np.arccos(np.clip(vectors.dot(found, directions), -1.0, 1.0)))
            angle = math.radians(GRAZING)
            light = np.array([math.cos(angle), 0.0, math.sin(angle)])
            change = float(vectors.dot(normalize(read), light)) / math.sin(angle) - 1.0
            rows.append(
                (
                    reader,
                    rounding,
                    ", ".join(str(int(byte)) for byte in stored),
                    float(read[0]),
                    _lean(read),
                    100.0 * change,
                    float(np.sqrt((errors * errors).mean())),
                )
            )
    columns = (
        Column("read by"),
        Column("bytes"),
        Column("flat texel"),
        Column("x read", form=".5f"),
        Column("lean", "degrees", ".3f"),
        Column("grazing light", "%", "+.1f"),
        Column("all normals, RMS", "degrees", ".3f"),
    )
    return Table(columns, tuple(rows))


def findings(table):
    """The error of half a byte, and which readers have it."""
    row = {(r["read by"], r["bytes"]): r for r in table.records()}
    real, cut = row["fragment program", "rounded"], row["fragment program", "cut off"]
    combiners, dots = row["combiners", "rounded"], row["dot products", "rounded"]
    worst = row["combiners", "cut off"]
    return (
        f"The document's flat texel is ({real['flat texel']}). A fragment program reads its x as "
        f"{real['x read']:.5f}, and flat areas lean {real['lean']:.3f} degrees. Cut off instead of rounded, "
        f"the texel is ({cut['flat texel']}), and they lean {cut['lean']:.3f} degrees the other way.",
        f"Combiners and dot products take 128 for zero. There the same bytes lean {combiners['lean']:.3f} "
        f"and {dots['lean']:.3f} degrees, but {worst['lean']:.3f} if they were cut off.",
        f"A light is {GRAZING:g} degrees above a flat wall. The fragment program's brightness is "
        f"{real['grazing light']:+.1f} % off, that of combiners {combiners['grazing light']:+.1f} %.",
        f"Over all normals the document's bytes are {real['all normals, RMS']:.3f} degrees off (RMS) if "
        f"they are read as real numbers. Read by combiners they are {combiners['all normals, RMS']:.3f} "
        "off, because the combiners' zero is half a byte from the document's.",
    )


def checks(table):
    """The catalogue's number, and the readers without such a lean."""
    row = {(r["read by"], r["bytes"]): r for r in table.records()}
    real = row["fragment program", "rounded"]
    place = math.degrees(math.sqrt(2.0) / (_PLACES * _ENLARGED))
    return (
        DATA.check(
            "lean of a flat area in degrees, of .318: deviation", abs(real["lean"] - 0.318), Answer.MACHINE
        ),
        DATA.check(
            "x of a flat texel times 255, of 1: deviation", abs(255.0 * real["x read"] - 1.0), Answer.MACHINE
        ),
        DATA.check(
            "lean of a flat area in combiners, degrees", row["combiners", "rounded"]["lean"], Answer.MACHINE
        ),
        DATA.check(
            "lean of a flat area in dot products, degrees",
            row["dot products", "rounded"]["lean"],
            Answer.MACHINE,
            at_most=place,
        ),
        DATA.check(
            "lean in combiners where bytes were cut off, of .640: deviation",
            abs(row["combiners", "cut off"]["lean"] - 0.640),
            Answer.MACHINE,
        ),
        DATA.check(
            "all normals in the fragment program, RMS degrees", real["all normals, RMS"], Answer.MACHINE
        ),
    )


def plot(axes, table):
    """The lean of flat areas and the error over all normals, by reader."""
    lean, every = axes
    at = np.arange(len(READERS))
    for shift, rounding, color in ((-0.2, "rounded", BLUE), (0.2, "cut off", ORANGE)):
        rows = [r for r in table.records() if r["bytes"] == rounding]
        lean.bar(at + shift, [r["lean"] for r in rows], 0.38, color=color, label=rounding)
        every.bar(at + shift, [r["all normals, RMS"] for r in rows], 0.38, color=color, label=rounding)
    lean.plot([-0.2], [0.318], label="catalogue", **EXPECTED)
    lean.set_ylabel("lean of a flat area, degrees")
    every.set_ylabel("error over all normals, RMS degrees")
    for ax in axes:
        ax.set_xticks(at, READERS)
        ax.legend()


STUDY = Study(
    **DATA.words,
    method=(
        "A flat texel's dot products with the axes, drawn by the ideal (which reads bytes as a fragment "
        "program does) and by the machine's combiners; its place in a table looked up by two dot "
        f"products of a texture shader; and the angle between {_NORMALS} normals and what is read of them."
    ),
    machines=("GEFORCE_3", "NV2A"),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
