"""P38: the effect of a texture cache on dependent lookups.

The first case is Ward's model by pixel textures (K09) on the Octane. It reads the material textures in the
order of the pixels, and the table of E(m, d) at places that depend on the bumps. The second case, on the same
bumps (G10), looks up light at S_i, the texels that are visible along some directions. It reads S_i and the
normal map in order, and L_d not in order.

Source: Kautz, Seidel 2000, section 5.1 (memory stalls of dependent lookups; artefact P38 of the catalogue);
Heidrich, Daubert, Kautz, Seidel 2000, section 3.3.
"""

from collections import OrderedDict
from itertools import pairwise

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import study_data
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.reflectance import material_textures, pixel_textures
from fixedpipe.effects.scattering import height_field
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.effects.scattering.visibility_textures import looked_up_size
from fixedpipe.effects.studies.study import BLUE, GREEN, ORANGE, RED, Column, Study, Table
from fixedpipe.pipeline.commands import CopyPixels, TexImage
from fixedpipe.pipeline.execution.machine import execute

DATA = study_data(__file__, "P38")

# Source: the catalogue's example of a cache. Assumed: it drops the line that was not used for the longest
# time, and textures are stored in blocks of a line, as caches of textures need; documentation of a chip
# would settle both.
CACHE_BYTES, LINE_BYTES = 4096, 32
DEPTHS = (0.0, 0.1, 0.2, 0.4, 0.8, 1.6)
# Up to here bumps spread the lookups; steeper ones send many beyond the largest m that is stored.
STEEP = 0.8
_SIZE, _CELLS = 128, 12
# Width and height in texels of the blocks, by the bytes of a texel: RGBA8, S_i's two, the tables' LUMINANCE8.
_BLOCKS = {4: (4, 2), 2: (4, 4), 1: (8, 4)}
# Directions over the sphere along which the bumps see each other.
_DIRECTIONS = 48


def misses(lines):
    """How many of the accesses to these lines, in order, miss a cache that is empty at first."""
    held, missed = OrderedDict(), 0
    for line in lines:
        if line in held:
            held.move_to_end(line)
        else:
            missed += 1
            held[line] = None
            if len(held) > CACHE_BYTES // LINE_BYTES:
                held.popitem(last=False)
    return missed


def lines_of(s, t, width, height, texel_bytes):
    """The cache lines, int64 [4 n], that LINEAR reads at coordinates [n], with four texels for each.
    Coordinates are clamped at the texture's edges.
    """
    across, up = _BLOCKS[texel_bytes]
    x, y = np.floor(s * width - 0.5).astype(np.int64), np.floor(t * height - 0.5).astype(np.int64)
    taps = []
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        column, row = np.clip(x + dx, 0, width - 1), np.clip(y + dy, 0, height - 1)
        taps.append((row // up) * -(-width // across) + column // across)
    return np.stack(taps, axis=-1).ravel()


def nearest_lines(column, row, width, texel_bytes):
    """The cache lines, int64 [n], that NEAREST reads at texels, one line for each."""
    across, up = _BLOCKS[texel_bytes]
    return ((row // up) * -(-width // across) + column // across).ravel()


def light_at_seen(field):
    """Misses of L_d at S_i in percent: of all lookups, and of those that see something.

    It is the mean over all directions in which some lookup sees something. A lookup that sees nothing reads
    the last texel.
    """
    width, height = (looked_up_size(edge) for edge in (field.columns, field.rows))
    missed, found, lookups = 0, 0, 0
    for seen in precompute(field, spiral(_DIRECTIONS)).seen:
        if (seen >= 0).any():
            column = np.where(seen < 0, width - 1, seen % field.columns)
            row = np.where(seen < 0, height - 1, seen // field.columns)
            missed += misses(nearest_lines(column, row, width, 4).tolist())
            found, lookups = found + int((seen >= 0).sum()), lookups + seen.size
    return (100.0 * missed / lookups, 100.0 * missed / found) if found else (0.0, None)


def read_in_order(texel_bytes):
    """Misses in percent of a texture that NEAREST reads texel by texel."""
    row, column = np.mgrid[0:_SIZE, 0:_SIZE]
    return miss_rate(nearest_lines(column, row, _SIZE, texel_bytes))


def miss_rate(lines):
    """Misses in percent of accesses."""
    return 100.0 * misses(lines.tolist()) / len(lines)


def bumps(depth):
    """Heights of pebbles of this depth. The unit is the edge of their square."""
    return height_fields.smooth(height_fields.pebbles(_SIZE, _SIZE, _CELLS, 5), 2) * depth


def frame(depth, profile):
    """The commands of Ward's model on a square of pebbles of this depth, a pixel for each texel; and its
    slopes.
    """
    heights = bumps(depth)
    slopes = height_fields.slopes(heights)
    material = material_textures.from_slopes(*slopes, 0.2, 0.5)
    panel = Panel(0, 0, _SIZE, _SIZE)
    light = Light((0.5, 0.4, 0.77))
    passes = pixel_textures.ward(
        surfaces.plane(), material, orthographic_view(panel), light, profile, largest_s=2.0
    )
    return (panel.clear((0.0, 0.0, 0.0)), *passes), np.sqrt(slopes[0] ** 2 + slopes[1] ** 2)


def lookups(commands, profile):
    """The lookups of a frame's pixel textures, by table: coordinates s and t of every pixel, bottom row
    first, which the framebuffer held before the copy; and the table's width and height.
    """
    result = execute(commands, profile, _SIZE, _SIZE, trace=True)
    tables = {c.texture: c.image for c in commands if isinstance(c, TexImage) and c.image is not None}
    found = {}
    for before, command in zip(result.trace, commands[1:], strict=False):
        if isinstance(command, CopyPixels) and command.pixel_texture is not None:
            groups = before.color[::-1].reshape(-1, 4) / 255.0
            (s, t), (unit,) = command.transfer.color_matrix[:2], command.state.texture_units
            height, width = tables[unit.texture].levels[0].shape[1:3]
            found[unit.texture] = (*(_product(groups, row) for row in (s, t)), width, height)
    return found


def _product(groups, row):
    return sum(groups[:, k] * row[k] for k in range(4))


def measure(profile):
    """The table, with a row for each depth of the bumps."""
    at = height_fields.texel_centers(_SIZE, _SIZE)
    material = miss_rate(lines_of(*(a.ravel() for a in at), _SIZE, _SIZE, 4))
    rows = []
    curves = {name: np.array([read_in_order(b)]) for name, b in (("S_i", 2), ("normal map", 4))}
    for depth in DEPTHS:
        commands, slope = frame(depth, profile)
        found = lookups(commands, profile)
        rates = {name: miss_rate(lines_of(*place, 1)) for name, place in found.items()}
        touched = len(np.unique(lines_of(*found["E"], 1)))
        rows.append(
            (
                depth,
                float(np.sqrt((slope * slope).mean())),
                material,
                rates["S"],
                rates["E"],
                rates["E"] / material,
                touched * LINE_BYTES / 1024.0,
                100.0 * float((found["E"][0] >= 1.0).mean()),
                *light_at_seen(height_field.height_field(bumps(depth))),
            )
        )
        curves[f"s {depth:g}"], curves[f"t {depth:g}"] = found["E"][:2]
    columns = (
        Column("depth", form=".2f"),
        Column("slope, RMS", form=".3f"),
        Column("material textures", "% missed", ".2f"),
        Column("S(p)", "% missed", ".2f"),
        Column("E(m, d)", "% missed", ".2f"),
        Column("E over material", form=".2f"),
        Column("E touched", "KB", ".1f"),
        Column("m at 8", "%", ".1f"),
        Column("L_d", "% missed", ".2f"),
        Column("L_d, seen", "% missed", ".1f"),
    )
    return Table(columns, tuple(rows), curves)


def findings(table):
    """The miss rates of the smooth and of the roughest surface."""
    rows = {r["depth"]: r for r in table.records()}
    smooth, rough, steepest = rows[0.0], rows[STEEP], rows[DEPTHS[-1]]
    return (
        f"The material textures miss {smooth['material textures']:.2f} % of their accesses, however rough "
        f"the bumps are. E(m, d) misses {smooth['E(m, d)']:.2f} % on a smooth surface. At a depth of "
        f"{STEEP:g} it misses {rough['E(m, d)']:.2f} %, {rough['E over material']:.1f} times as many as the "
        f"material. At {DEPTHS[-1]:g} it misses {steepest['E(m, d)']:.2f} %; there {steepest['m at 8']:.0f} "
        "% of the lookups have the largest m that is stored.",
        f"At {STEEP:g} the bumps touch {rough['E touched']:.1f} KB of the table of E, compared with a cache "
        f"of {CACHE_BYTES // 1024} KB. The row of S(p) misses {rough['S(p)']:.2f} %.",
        f"S_i, read texel by texel, misses {table.curves['S_i'][0]:.2f} % of its accesses, the normal map "
        f"{table.curves['normal map'][0]:.2f} %. At {STEEP:g}, L_d misses {rough['L_d, seen']:.1f} % of the "
        f"lookups that see something, {rough['L_d, seen'] / table.curves['normal map'][0]:.1f} times as "
        f"many as the normal map. Of all lookups it misses {rows[0.1]['L_d']:.2f} % at 0.1 and "
        f"{steepest['L_d']:.2f} % at {DEPTHS[-1]:g}, because rougher bumps see more of each other.",
    )


def checks(table):
    """The rate grows with roughness, and is larger than that of the material textures."""
    rates = [r["E(m, d)"] for r in table.records() if r["depth"] <= STEEP]
    (material,) = set(table.column("material textures"))
    grows = min(b - a for a, b in pairwise(rates))
    light = table.column("L_d")
    seen = [rate for rate in table.column("L_d, seen") if rate is not None]
    return (
        DATA.check(
            "least growth of E's miss rate between depths up to {steep:g}, %",
            grows,
            Answer.MACHINE,
            steep=STEEP,
        ),
        DATA.check(
            "E's miss rate over the material's, steepest bumps",
            table.column("E over material")[-1],
            Answer.MACHINE,
        ),
        DATA.check(
            "E's miss rate over the material's, smooth surface",
            table.column("E over material")[0],
            Answer.MACHINE,
        ),
        DATA.check(
            "the material's miss rate, of 100/32 %: relative deviation",
            abs(material / 3.125 - 1.0),
            Answer.MACHINE,
        ),
        DATA.check(
            "least growth of L_d's miss rate from depth to depth, %",
            min(b - a for a, b in pairwise(light)),
            Answer.MACHINE,
        ),
        DATA.check(
            "L_d's miss rate of lookups that see something, over the normal map's, at least",
            min(seen) / float(table.curves["normal map"][0]),
            Answer.MACHINE,
        ),
    )


def plot(axes, table):
    """The rates by slope, and the places of the lookups in the table."""
    rates, places = axes
    slope = table.column("slope, RMS")
    for name, color, marker in (
        ("E(m, d)", RED, "o"),
        ("S(p)", GREEN, "^"),
        ("material textures", BLUE, "s"),
        ("L_d", ORANGE, "v"),
    ):
        rates.plot(slope, table.column(name), color=color, marker=marker, label=name)
    rates.set_xlabel("slope of the bumps, RMS")
    rates.set_ylabel("accesses that miss, %")
    rates.set_ylim(bottom=0.0)
    rates.legend()
    for depth, color in ((1.6, ORANGE), (0.4, RED), (0.1, BLUE)):
        places.plot(
            table.curves[f"s {depth:g}"], table.curves[f"t {depth:g}"], ",", color=color, rasterized=True
        )
        places.plot([], [], "s", color=color, label=f"depth {depth:g}")
    places.set_xlabel("m / 8, across the table of E")
    places.set_ylabel("d, up the table of E")
    places.set_xlim(-0.02, 1.02)
    places.set_ylim(-0.02, 1.02)
    places.legend(loc="lower right")


STUDY = Study(
    **DATA.words,
    method=(
        f"The lookups of K09's frame on pebbles, {_SIZE} x {_SIZE} pixels, in the order of the pixels, "
        f"through a cache of {CACHE_BYTES // 1024} KB with lines of {LINE_BYTES} bytes; four texels for "
        f"each. L_d at S_i on the same pebbles along {_DIRECTIONS} directions; one texel for each."
    ),
    machines=("OCTANE",),
    panels=2,
    measure=measure,
    findings=findings,
    checks=checks,
    plot=plot,
)
