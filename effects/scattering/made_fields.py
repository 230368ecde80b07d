"""Height fields of things: a wall of bricks, boards of a fence, gravel. All are periodic, over a unit square.

Their random parts come from an integer hash, so they have the same bits everywhere. Assumed: sizes, depths
and colours. They look like the paper's brick wall and figure 12, for which no measurements exist.
"""

import numpy as np

from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.scattering.height_field import height_field


def _part(number, seed, k):
    """A number in [0, 1) for each whole number, by the hash."""
    return height_fields.hashed(number, np.full(np.shape(number), k), seed) / 65536.0


def _smooth_step(x):
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


def _grain(columns, rows, cells_s, cells_t, seed):
    """Noise in [-1, 1] that is finer in one direction, by two octaves."""
    coarse = height_fields.value_noise(columns, rows, cells_s, cells_t, seed)
    return (coarse + 0.5 * height_fields.value_noise(columns, rows, 2 * cells_s, 2 * cells_t, seed + 1)) / 1.5


def bricks(columns=128, rows=128, depth=0.03, seed=3, count=2):
    """``count`` bricks and three times as many courses, each moved by half a brick.

    ``depth`` is the joints' depth, in edges of the square. A brick is 215 mm by 65 mm, a joint 10 mm, and the
    square ``count`` times 225 mm.

    Raises ValueError for an odd number of courses, which could not repeat.
    """
    if count < 2 or count % 2:
        raise ValueError(f"The wall has {count} bricks across; give an even number from 2 on.")
    s, t = height_fields.texel_centers(columns, rows)
    course = np.floor(t * 3.0 * count).astype(np.int64)
    along = s * count + 0.5 * (course % 2)
    brick = np.floor(along).astype(np.int64) % count + count * course
    # Millimetres from the brick's edge, negative in the joint.
    across = 107.5 - np.abs((along - np.floor(along) - 0.5) * 225.0)
    up = 32.5 - np.abs((t * 3.0 * count - course - 0.5) * 75.0)
    inside = np.minimum(across, up)
    rough = height_fields.turbulence(s, t, 6 * count, 3, seed)
    stands = 0.75 + 0.25 * _part(brick, seed, 1) + 0.12 * rough
    heights = depth * (_smooth_step((inside + 2.0) / 7.0) * stands + 0.06 * rough)
    shade = 0.85 + 0.3 * _part(brick, seed, 2) + 0.15 * rough
    red, pale = np.array([0.58, 0.26, 0.18]), np.array([0.64, 0.40, 0.27])
    blend = _part(brick, seed, 3)[..., None]
    clay = (red * (1.0 - blend) + pale * blend) * shade[..., None]
    mortar = np.array([0.66, 0.63, 0.57]) * (1.0 + 0.12 * rough)[..., None]
    share = _smooth_step((inside + 2.0) / 4.0)[..., None]
    return height_field(heights, np.clip(mortar * (1.0 - share) + clay * share, 0.0, 1.0))


def planks(columns=128, rows=128, count=4, depth=0.04, seed=5):
    """``count`` boards side by side that run along t. ``depth`` is the gaps' depth, in edges of
    the square.
    """
    s, t = height_fields.texel_centers(columns, rows)
    board = np.floor(s * count).astype(np.int64)
    inside = 0.5 - np.abs(s * count - board - 0.5)
    grain = _grain(columns, rows, 16 * count, 2, seed)
    wave = height_fields.turbulence(s, t, 3, 2, seed)
    stands = 0.8 + 0.2 * _part(board, seed, 1) + 0.08 * grain + 0.06 * wave
    heights = depth * _smooth_step((inside - 0.015) / 0.05) * stands
    shade = (0.75 + 0.35 * _part(board, seed, 2)) * (1.0 + 0.22 * grain + 0.12 * wave)
    wood = np.array([0.62, 0.46, 0.30]) * shade[..., None]
    return height_field(heights, np.clip(wood, 0.02, 1.0))


def gravel(columns=128, rows=128, cells=10, depth=0.6, seed=7):
    """A bed of ``cells`` x ``cells`` round stones, ``depth`` times as high as half balls."""
    heights = height_fields.pebbles(columns, rows, cells, seed)
    s, t = height_fields.texel_centers(columns, rows)
    hue = height_fields.gradient_noise(s, t, cells, seed)
    speck = height_fields.turbulence(s, t, 4 * cells, 2, seed + 1)
    lower = _smooth_step(heights * cells / 0.35)
    shade = (0.55 + 0.45 * lower) * (1.0 + 0.3 * hue + 0.15 * speck)
    stone = np.array([0.64, 0.59, 0.52]) + 0.06 * hue[..., None] * np.array([1.0, 0.2, -0.6])
    return height_field(height_fields.smooth(heights) * depth, np.clip(stone * shade[..., None], 0.02, 1.0))


def scales(columns=128, rows=128, count=8, depth=0.5, seed=9):
    """Scales like a fish's, ``count`` x ``count`` of them in staggered rows.

    Each rises along t to its round tip, under which the next ones begin. ``depth`` is the height of the tips,
    in widths of a scale.

    Raises ValueError for an odd count, because its staggered rows could not repeat.
    """
    if count < 2 or count % 2:
        raise ValueError(f"There are {count} x {count} scales; give an even number from 2 on.")
    s, t = height_fields.texel_centers(columns, rows)
    x, y = s * count, t * count
    heights, tone = np.zeros((rows, columns)), np.zeros((rows, columns))
    for row in range(-2, 2):
        j = np.floor(y).astype(np.int64) + row
        moved = x - 0.5 * (j % 2)
        for column in (-1, 0, 1):
            i = np.floor(moved).astype(np.int64) + column
            across, along = moved - (i + 0.5), y - j
            # An outline that is round at its tip, 1.6 rows above its root.
            out = np.maximum(along - 0.85, 0.0) / 0.75
            edge = 1.0 - np.sqrt((across / 0.56) * (across / 0.56) + out * out)
            inside = (edge > 0.0) & (along > -0.6)
            rise = _smooth_step(edge / 0.16) * (0.35 + 0.4 * along) * (1.0 - 0.6 * across * across)
            keel = 0.1 * _smooth_step(1.0 - np.abs(across) / 0.1)
            found = np.where(inside, rise + keel * (along < 1.2), 0.0)
            above = found > heights
            own = _part(i % count + count * (j % count), seed, 1) + 0.5 * edge
            heights, tone = np.where(above, found, heights), np.where(above, own, tone)
    deep = _smooth_step((heights - 0.25) / 0.35)[..., None]
    tone = np.clip(0.7 * tone, 0.0, 1.0)[..., None]
    bronze, gold, patina = (np.array(c) for c in ((0.52, 0.30, 0.14), (0.90, 0.66, 0.30), (0.10, 0.33, 0.28)))
    skin = (bronze * (1.0 - tone) + gold * tone) * deep + patina * (1.0 - deep)
    return height_field(height_fields.smooth(heights) * depth / count, np.clip(skin, 0.02, 1.0))


def honeycomb(columns=128, rows=128, across=7, along=8, depth=0.6, seed=6):
    """A comb of wax, ``across`` x ``along`` cells in staggered rows: hexagons, nearly regular with 7 x 8,
    open upwards.

    ``depth`` is the cells' depth, in widths of a cell.

    Raises ValueError for an odd number of rows, because staggered ones could not repeat.
    """
    if across < 2 or along < 2 or along % 2:
        raise ValueError(f"The comb has {along} rows of {across} cells; give an even number of rows, from 2.")
    s, t = height_fields.texel_centers(columns, rows)
    x, y = s * across, t * along
    nearest, cell = np.full((rows, columns), np.inf), np.zeros((rows, columns))
    for row in (-1, 0, 1):
        j = np.floor(y).astype(np.int64) + row
        moved = x - 0.5 * (j % 2)
        for column in (-1, 0, 1):
            i = np.floor(moved).astype(np.int64) + column
            u, v = np.abs(moved - (i + 0.5)), np.abs(y - (j + 0.5))
            # The hexagon whose flat sides are left and right: 1/2 on its edge. A row is 3/4 of its height.
            distance = np.maximum(u, 0.5 * u + 0.75 * v)
            cell = np.where(distance < nearest, i % across + across * (j % along), cell)
            nearest = np.minimum(nearest, distance)
    own = _part(cell.astype(np.int64), seed, 1)
    wall = _smooth_step((nearest - 0.26) / 0.2)
    heights = depth / across * (wall + 0.12 * own * (1.0 - wall))
    rough = height_fields.turbulence(s, t, 3 * across, 2, seed)
    honey, wax = np.array([0.95, 0.66, 0.24]), np.array([0.98, 0.86, 0.56])
    share = np.clip(wall + 0.25 * rough, 0.0, 1.0)[..., None]
    color = (honey * (1.0 - share) + wax * share) * (0.94 + 0.06 * own)[..., None]
    return height_field(height_fields.smooth(heights), np.clip(color, 0.02, 1.0))
