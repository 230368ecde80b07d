"""Whether the rows of a pass keep every kernel inside its arrays, whoever wrote them.

``pipeline/native/`` writes no others; a caller of kernels may. An entry that only changes a value is not
looked at: any bits give some picture. The cost is some hundred comparisons for a whole draw.
"""

from numba import boolean, int64

from fixedpipe.raster import codes as C
from fixedpipe.raster import rows as R
from fixedpipe.raster.kernel import float_of, kernel
from fixedpipe.raster.portable.arrays import PASS

FOG_TABLE = 8193  # entries of a table of factors
MOST_PROBES = 16  # of a footprint: sums of 16 bytes leave room in 16 bits
MOST_TAPS = 16.0  # the largest anisotropy; the EXT_texture_filter_anisotropic of any chip stays below


@kernel
def usable_input(row, at):
    """Whether an input names a register and a component of it."""
    return 0 <= row[at] < R.REGISTERS and C.USAGE_RGB <= row[at + 1] <= C.USAGE_BLUE


@kernel
def usable_program(draw, combiners):
    """Whether stages and constants are there, and inputs and outputs name registers."""
    program, final, constants = combiners.program, combiners.final, combiners.constants
    stages = draw[R.STAGES]
    if stages < 0 or stages > program.shape[0] or constants.shape[1] < 8:
        return False
    if constants.shape[0] < (stages + 1 if draw[R.STAGE_CONSTANTS] else 1):
        return False
    if program.shape[1] < 2 or program.shape[2] < R.PORTION_SIZE:
        return False
    for stage in range(stages):
        for half in range(2):
            row = program[stage, half]
            for k in range(4):
                if not usable_input(row, k * R.INPUT_SIZE):
                    return False
            for output in range(3):
                if row[R.AB_OUTPUT + output] >= R.REGISTERS:
                    return False
    if final.shape[0] < 7 or final.shape[1] < R.FINAL_SIZE:
        return False
    named = True
    for k in range(7):
        named = named and usable_input(final[k], 0)
    return named


@kernel
def usable_levels(row, levels, texels, pairs):
    """Whether every level that a unit may read lies inside its texels; ``pairs``: which are row pairs, of one
    column more.
    """
    count, layers = row[R.LEVELS], row[R.LAYERS]
    layered, cube = row[R.TARGET] == C.TARGET_3D, row[R.TARGET] == C.TARGET_CUBE_MAP
    if count < 1 or count > levels.shape[0] or (layered and layers < 1):
        return False
    for k in range(count):
        offset, width, height = int64(levels[k, 0]), int64(levels[k, 1]), int64(levels[k, 2])
        images = max(layers >> k, 1) if layered else (int64(6) if cube else int64(1))
        if offset < 0 or width < 1 or height < 1 or images > texels:
            return False
        if width > texels or height > texels:
            return False
        area = 2 * (width + 1) * height if pairs else width * height
        if area > texels or offset + images * area > texels:
            return False
    return True


@kernel
def usable_stage(row, unit, units):
    """Whether a texture shader stage reads stages and units that there are."""
    operation = row[R.OPERATION]
    if not C.OPERATION_NONE <= operation <= C.LAST_OPERATION or not 0 <= row[R.PREVIOUS] < R.MAX_UNITS:
        return False
    if not 0 <= row[R.ROUGHNESS] <= R.MAX_UNITS:
        return False
    if operation == C.OPERATION_DOT_PRODUCT_DIFFUSE_CUBE_MAP and unit + 1 >= units:
        return False
    if operation >= C.FIRST_AFTER_TWO_STAGES:
        return unit >= 2
    return unit >= 1 or operation < C.FIRST_AFTER_ONE_STAGE


@kernel
def usable_units(draw, textures):
    """Whether the texture units are there, and their stages read what there is."""
    units, levels = textures.units, textures.levels
    count = draw[R.UNITS]
    if count < 0 or count > min(4, min(units.shape[0], levels.shape[0])):
        return False
    if units.shape[1] != R.UNIT_SIZE or levels.shape[1] != R.MAX_LEVELS or levels.shape[2] != 3:
        return False
    for u in range(count):
        row = units[u]
        if not row[R.ENABLED]:
            continue
        if not usable_stage(row, u, count):
            return False
        if row[R.ANISOTROPY]:
            ratio = float_of(row[R.ANISOTROPY])
            if not (ratio >= 1.0 and ratio <= MOST_TAPS):
                return False
        if not usable_bits(row[R.TEXEL_BITS]):
            return False
        if row[R.PROBES] < 0 or row[R.PROBES] > MOST_PROBES:
            return False
    return True


@kernel
def reads_texture(operation):
    """Whether a texture shader's operation, or none, reads its unit's texture (``texture_shader``)."""
    if operation == C.OPERATION_NONE or operation == C.OPERATION_TEXTURE_CUBE_MAP:
        return True
    if operation <= C.OPERATION_CULL_FRAGMENT:  # and what rows have NONE for, which counts as this
        return False
    return operation not in (C.OPERATION_DOT_PRODUCT, C.OPERATION_DOT_PRODUCT_DEPTH_REPLACE)


@kernel
def usable_texels(draw, textures):
    """Whether what units read lies inside their texels."""
    units, levels = textures.units, textures.levels
    for u in range(draw[R.UNITS]):
        if not reads_texture(units[u, R.OPERATION]):
            continue
        size = textures.texels[u].shape[0]
        if units[u, R.TEXEL_BITS] != R.BITS_OF_BYTES:
            size //= 2  # two words each
        if units[u, R.ENABLED] and not usable_levels(units[u], levels[u], size, False):
            return False
    return True


@kernel
def usable_bits(bits):
    """Whether components of so many bits can be computed with."""
    return R.BITS_OF_BYTES <= bits <= R.MOST_BITS


@kernel
def usable_draw(state, fog, height, words):
    """Whether the box lies in the framebuffer, rows of so many ``words``, and what the other entries count is
    there.
    """
    draw, draw_float, factors = state.draw, state.draw_float, state.factors
    if draw.shape[0] < R.DRAW_SIZE or draw_float.shape[0] < R.DRAW_FLOAT_SIZE:
        return False
    if not (usable_bits(draw[R.BITS]) and usable_bits(draw[R.BUFFER_BITS])):
        return False
    width = words if draw[R.BUFFER_BITS] == R.BITS_OF_BYTES else words // 4
    if not (0 <= draw[R.X0] <= width and 0 <= draw[R.X1] <= width):
        return False
    if not (0 <= draw[R.Y0] <= height and 0 <= draw[R.Y1] <= height):
        return False
    if draw[R.CLIP_RECTANGLES] < 0 or draw[R.CLIP_RECTANGLES] > R.MAX_CLIP_RECTANGLES:
        return False
    if draw[R.COVER_SAMPLES] < 0 or draw[R.COVER_SAMPLES] > R.MAX_COVER_SAMPLES:
        return False
    if draw[R.LINE_WIDTH] < 0 or draw[R.LINE_WIDTH] > 1 << 16:
        return False
    if factors.shape[0] < 2 or factors.shape[1] < 4 * R.FACTOR_SIZE:
        return False
    thresholds = FOG_TABLE if draw[R.FOG_ENABLED] == C.FOG_BY_TABLE else (1 << draw[R.BITS]) - 1
    return not draw[R.FOG_ENABLED] or fog.thresholds.shape[0] >= thresholds


@kernel
def usable_vertices(draw, vertices, colors):
    """Whether vertices have every column that the draw reads."""
    count, coordinates = vertices.x.shape[0], vertices.coordinates
    if colors.shape[0] < count or coordinates.shape[0] < count or vertices.inverse_w.shape[0] < count:
        return False
    if colors.shape[1] < 2 or colors.shape[2] < 8:
        return False
    return coordinates.shape[1] >= draw[R.UNITS] and coordinates.shape[2] >= 4


@kernel
def usable_strokes(draw, triangles, strokes, vertices):
    """Whether primitives have every column that the draw reads, and strokes name vertices, of so many."""
    if triangles.shape[1] < 4 or strokes.shape[1] < R.STROKE_SIZE:
        return False
    if not draw[R.STROKES]:
        return True
    if strokes.shape[0] < triangles.shape[0]:
        return False
    for t in range(strokes.shape[0]):
        if strokes[t, 0] < 0 or strokes[t, 0] > C.PRIMITIVE_POINT or strokes[t, 1] < 0 or strokes[t, 1] > 1:
            return False
        for k in range(2, 5):
            if strokes[t, k] < -1 or strokes[t, k] >= vertices or (strokes[t, k] < 0) != (strokes[t, 2] < 0):
                return False
    return True


@kernel(boolean(PASS, int64, int64))
def usable(p, height, words):
    """Whether a Draw's arrays can be given to kernels; ``height`` rows of ``words`` of the framebuffer."""
    draw = p.state.draw
    return (
        usable_draw(p.state, p.fog, height, words)
        and usable_program(draw, p.combiners)
        and usable_vertices(draw, p.vertices, p.colors)
        and usable_strokes(draw, p.triangles, p.strokes, p.vertices.x.shape[0])
        and usable_units(draw, p.textures)
        and usable_texels(draw, p.textures)
    )
