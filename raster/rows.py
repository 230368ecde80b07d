"""Layout of the rows that kernels read: ``pipeline/native/`` writes them, and ``pipeline/vertices/`` those of
lines. Every entry is an integer unless it says so.

A state is packed so that two states that cannot differ in their result give equal rows: what is disabled is
zero.
"""

from fixedpipe.raster.codes import REGISTER_DISCARD

# ------------------------------------------------------------------ draw: int64[DRAW_SIZE]
(
    X0,  # device pixels, half open: the screen cut by the scissor box
    Y0,
    X1,
    Y1,
    CULL_POSITIVE,  # cull triangles whose area is positive
    CULL_NEGATIVE,
    BACK_SIGN,  # 0: all front; 1: A > 0 takes the back colour; -1: A < 0 does
    FLAT,  # codes.COLORS_...; 0: they are iterated
    DEPTH_FORMAT,  # codes.DEPTH_...
    DEPTH_MAX,  # fixed: 2**bits - 1
    DEPTH_CULL,  # 1: a depth outside its limits ends the fragment; 0: it is clamped
    W_BUFFERING,
    POLYGON_OFFSET,
    NEEDS_COLOR,  # 0: no colour is written and no alpha test looks at it
    NEEDS_PRIMARY,
    NEEDS_SECONDARY,
    NEEDS_COLOR_WEIGHTS,  # codes.WEIGHTS_...; 0: none
    NEEDS_ITERATION_WEIGHTS,  # weights with 24 significant bits: those, or texture coordinates
    NEEDS_WEIGHTS,  # full-precision weights
    NEEDS_DEPTH,
    UNITS,
    DIRECT,  # 1: the fragment is its primary colour, no combiners
    STAGES,
    COLOR_SUM,  # bits: codes.COLOR_SUM_...
    USES_E_TIMES_F,
    USES_SPARE0_PLUS_SECONDARY,
    WRITES_TEXTURE,  # 1: a stage writes the register of a disabled unit, which each batch must find unset
    STAGE_CONSTANTS,  # 1: constants change from stage to stage
    FOG_ENABLED,  # codes.FOG_BY_...: 255 thresholds, or a table of floor(4096 v); 0: no fog
    FOG_RISING,  # 1: the factor grows with the coordinate
    FOG_RED,
    FOG_GREEN,
    FOG_BLUE,
    ALPHA_TEST,
    ALPHA_FUNCTION,  # codes.COMPARISON_..., as every function here
    ALPHA_REFERENCE,
    STENCIL_TEST,
    STENCIL_FUNCTION,
    STENCIL_REFERENCE,
    STENCIL_MASK,
    STENCIL_WRITE_MASK,
    STENCIL_FAIL,  # three operations of STENCIL_OPERATION_SIZE entries
) = range(42)
STENCIL_OPERATION_SIZE = 5  # and, xor, add, low, high: clamp(((s & and) ^ xor) + add, low, high) & 255
STENCIL_DEPTH_FAIL = STENCIL_FAIL + STENCIL_OPERATION_SIZE
STENCIL_DEPTH_PASS = STENCIL_DEPTH_FAIL + STENCIL_OPERATION_SIZE
DEPTH_FUNCTION = STENCIL_DEPTH_PASS + STENCIL_OPERATION_SIZE
DEPTH_WRITE = DEPTH_FUNCTION + 1
BLEND = DEPTH_WRITE + 1  # codes.BLEND_...
BLEND_EQUATION = BLEND + 1  # codes.EQUATION_...
LOGIC_OPERATION = BLEND_EQUATION + 1  # codes.LOGIC_...
COLOR_MASK = LOGIC_OPERATION + 1  # 32 bits, as stored
TEXTURE_SHADER = COLOR_MASK + 1  # 1: stages read earlier stages' texels
DISCARDS = TEXTURE_SHADER + 1  # 1: shading may discard fragments
SURFACE = DISCARDS + 1  # 1: not four bytes, or a signed blend equation: through the three that follow
SURFACE_KEEP = SURFACE + 1  # 32 bits, as stored: those that the surface's format keeps
SURFACE_PAD = SURFACE_KEEP + 1  # 32 bits: those that are always one
SURFACE_ALPHA = SURFACE_PAD + 1  # as a factor: codes.SURFACE_ALPHA_...
STROKES = SURFACE_ALPHA + 1  # 1: some primitives are no triangles
LINE_WIDTH = STROKES + 1  # 1/8 pixel
PIXEL_WIDE = 8  # a line of one pixel
LINE_STEPS = LINE_WIDTH + 1  # codes.LINE_...
OFFSET_LINE = LINE_STEPS + 1  # polygon offset, of polygons drawn as lines and as points
OFFSET_POINT = OFFSET_LINE + 1
STIPPLE = OFFSET_POINT + 1
STIPPLE_WORD = STIPPLE + 1  # 32 words, device row 0 first, the leftmost pixel in the highest bit
LINE_FACTOR = STIPPLE_WORD + 32  # line stipple: how often each bit is used; 0: none
LINE_PATTERN = LINE_FACTOR + 1  # 16 bits, the first in the lowest
WINDOW_CLIP = LINE_PATTERN + 1  # codes.WINDOW_CLIP_...
CLIP_RECTANGLES = WINDOW_CLIP + 1
CLIP_RECTANGLE = CLIP_RECTANGLES + 1  # left, top, right, bottom of each in device pixels, half open
MAX_CLIP_RECTANGLES = 8
DRAW_SIZE = CLIP_RECTANGLE + 4 * MAX_CLIP_RECTANGLES

# -------- strokes: int32[primitives, STROKE_SIZE], or none: kind (codes.PRIMITIVE_...), takes the back
# colour, three source vertices; of a line in steps the first pixel along its longer axis and the one behind
# the last, and the line stipple's counter at the first.
KIND, BACK, SOURCE = range(3)
FIRST_STEP, END_STEP, COUNTER, STROKE_SIZE = range(5, 9)

# ---------------------------- blend factors: int32[2, 4 * FACTOR_SIZE]: source, destination; red, green,
# blue, alpha masks of S, D, As, Ad and the saturate term; a constant byte; xor (255: one minus)
FACTOR_SIZE = 7

# ------------------------------------------------------------ draw: float64[DRAW_FLOAT_SIZE]
DEPTH_LOW, DEPTH_HIGH, OFFSET_FACTOR, OFFSET_UNITS, DRAW_FLOAT_SIZE = range(5)

# ------------------------------------------- general combiner portions: int32[stages, 2, PORTION_SIZE]
# Four inputs of INPUT_SIZE entries: register, usage (codes.REGISTER_..., USAGE_...), and the mapping as
# min(max(x, low) * factor + addend, 255).
INPUT_SIZE = 5
(
    AB_OUTPUT,
    CD_OUTPUT,
    SUM_OUTPUT,
    AB_DOT,
    CD_DOT,
    MUX,  # the bit of SPARE0's alpha that selects, 128 or 1; 0: a sum
    BIAS,
    SCALE,  # codes.SCALE_...
    AB_BLUE,  # 1: blue goes to the output's alpha as well
    CD_BLUE,
    PORTION_SIZE,
) = range(4 * INPUT_SIZE, 4 * INPUT_SIZE + 11)

# -------------------------------------- final combiner: int32[7, FINAL_SIZE]: register, usage, invert
FINAL_SIZE = 3

# --------------------------------------------------------------- units: int64[units, UNIT_SIZE]
(
    ENABLED,
    TARGET,  # codes.TARGET_...
    LEVELS,
    WRAP_S,  # codes.WRAP_..., as WRAP_T and WRAP_R
    WRAP_T,
    MAG_LINEAR,
    MIN_LINEAR,  # within a level
    MIPMAP,  # codes.MIPMAP_...
    LOD_BIAS,  # 8 fraction bits
    THRESHOLD,  # lambda up to which the texture is magnified, 8 fraction bits
    BORDER,  # packed RGBA
    PROJECTIVE,  # 1: divide by q
    WRAP_R,
    LAYERS,  # of level 0 of a 3D texture
    MIN_LOD,  # 8 fraction bits, as MAX_LOD
    MAX_LOD,
    SIGNED,  # packed: 0x80 in each signed component, whose texels and border come with that bit inverted
    OPERATION,  # codes.OPERATION_...; 0: the unit samples its texture
    PREVIOUS,  # previous texture input
    MAPPING,  # codes.DOT_MAPPING_...
    CULL_MODES,  # bit k: coordinate k's codes.CULL_MODE_...
    COMPARE,  # codes.COMPARE_MODE_...
    COMPARE_FUNCTION,
    COMPARE_HELD,  # packed: what takes a texel's place where the comparison holds
    COMPARE_FAILED,
    HILO,  # 1: texels are two words of 16 bits, alpha and red, green and blue
    DEPTH_TEXEL_MAX,  # the largest depth word of a compared texture
    DEPTH_TEXEL_FORMAT,  # codes.DEPTH_...
    ANISOTROPY,  # the largest ratio, a float64's bit pattern; 0: isotropic
    PROBES,  # the most probes of a footprint, a power of two; 0: none are assembled
    OFFSET_MATRIX,  # four entries; these and the following are bit patterns of float64
) = range(31)
OFFSET_SCALE = OFFSET_MATRIX + 4
OFFSET_BIAS = OFFSET_SCALE + 1
CONSTANT_EYE = OFFSET_BIAS + 1  # three entries
COORDINATE_DEPTH = CONSTANT_EYE + 3  # depth units for one unit of a coordinate that is a depth
UNIT_SIZE = COORDINATE_DEPTH + 1

# ------------------------------ texture levels: int32[units, MAX_LEVELS, 3]: offset, width, height
MAX_UNITS = 4
MAX_LEVELS = 16  # the ideal profile's largest texture, 2**14 texels an edge, has 15

REGISTERS = REGISTER_DISCARD  # those before it have four planes each: red, green, blue, alpha

# Scratch columns of a batch. floats float64[FLOAT_COLUMNS, batch]: texture coordinates (for a cube map, of
# its face, doubled), weights of vertices 0 and 2 with 24 significant bits, sizes of each fragment's level, a
# texel coordinate, a cube map's r or q, weights of vertices 0 and 2, depth before it is a word; a 3D
# texture's r with its size.
(
    S,
    T,
    Q0,
    Q2,
    S_SIZE,
    T_SIZE,
    TEXEL,
    EXTRA,
    B0,
    B2,
    P,
    P_SIZE,
    COORDINATE0,  # four coordinates of a texture shader stage
) = range(13)
DOT0 = COORDINATE0 + 4  # the stages' dot products
DEPTH = DOT0 + 4
# Anisotropic filters: a fragment's own S and T, its footprint's longer side, and how much longer that is, or
# how many probes it takes.
CENTER_S, CENTER_T, ALONG_S, ALONG_T, RATIO = range(DEPTH + 1, DEPTH + 6)
FLOAT_COLUMNS = RATIO + 1
# ints int32[INT_COLUMNS, batch]: cube face; where the level begins and its width; neighbouring columns and
# rows with their fractions; level, fraction between levels, lambda; colour weights; the triangle of a run;
# neighbouring layers with their fraction; the depth word that texels are compared with.
(
    FACE,
    BASE,
    WIDTH,
    I0,
    I1,
    I_FRACTION,
    J0,
    J1,
    J_FRACTION,
    LEVEL,
    FRACTION,
    LOD,
    W0,
    W2,
    OWNER,
    K0,
    K1,
    K_FRACTION,
    REFERENCE,
    INT_COLUMNS,
) = range(20)
# packed uint32[PACKED_COLUMNS, batch]: the four texels of a linear filter; filtered texels, the upper layer's
# among them; the texel of each texture shader stage.
P00, P10, P01, P11, TEXEL_0, TEXEL_1, MAGNIFIED, LAYER_1, STAGE0 = range(9)
SUM_EVEN, SUM_ODD = STAGE0 + 4, STAGE0 + 5  # an anisotropic filter's sums of bytes 0 and 2, and 1 and 3
PACKED_COLUMNS = SUM_ODD + 1

# ----------------------------------------------------------------- the vector engine (raster/vector/frame.py)
SLACK = 32  # elements of every column behind a batch: vectors may reach so far

# More columns of floats: what fragments of mixed segments carry of their triangle: edge functions; 1/w of the
# vertices, or in the first the reciprocal of the area; depths of the vertices, their differences, the
# reciprocal of the area for depths, polygon offset; of each texture unit, for s, t, r and q, the coordinate
# of vertex 1 and how far vertices 0 and 2 are from it.
N0, N1, N2, INVERSE_W0, INVERSE_W1, INVERSE_W2 = range(FLOAT_COLUMNS, FLOAT_COLUMNS + 6)
Z0, Z1, Z2, Z10, Z20, Z21, Z_RECIPROCAL, Z_OFFSET, TERMS = range(INVERSE_W2 + 1, INVERSE_W2 + 10)
VECTOR_FLOAT_COLUMNS = TERMS + 12 * 4
# More columns of ints: floor(256 u size) of s and t of each unit; the pixel, y * width + x, of each fragment
# of a mixed segment; depth words.
FIXED0 = INT_COLUMNS
PIXEL, DEPTH_WORD, VECTOR_INT_COLUMNS = range(FIXED0 + 2 * 4, FIXED0 + 2 * 4 + 3)
# More planes behind the registers: base and two differences of each colour channel in mixed segments.
SPARE_PLANES = 24  # for what combiners compute
COLOR_TERMS = REGISTERS * 4 + SPARE_PLANES
VECTOR_PLANES = COLOR_TERMS + 3 * 8
# More columns of packed: the fragments' colours.
SHADED, VECTOR_PACKED_COLUMNS = PACKED_COLUMNS, PACKED_COLUMNS + 1
# lists int32[LISTS, batch + SLACK]: segments and runs of a batch. A run with RUN_Y -1 is a mixed segment.
STARTS, OWNERS, BACKS, RUN_STARTS, RUN_X, RUN_Y, LISTS = range(7)

# jobs int64[n, JOB_SIZE]: what a queued command is. A Clear: device pixels, half open; buffers
# (codes.BUFFER_...), values and masks as stored. A Draw: addresses of its arrays, in the order of
# ``frame.fill_draw``'s arguments but for the textures, their lengths, and how it is drawn.
(
    JOB_KIND,  # codes.JOB_...
    JOB_X0,
    JOB_Y0,
    JOB_X1,
    JOB_Y1,
    JOB_BUFFERS,
    JOB_COLOR,
    JOB_COLOR_MASK,
    JOB_DEPTH,
    JOB_STENCIL,
    JOB_STENCIL_MASK,
    JOB_ROW_RUNS,  # 1: every row of a small triangle is a run (lambda needs them)
    JOB_USABLE,  # 1: what the units read lies inside their row pairs
    JOB_PERSPECTIVE,  # 1: some 1/w differ
    JOB_ONE_COLOR,  # 1: no vertex has colours of its own
    JOB_VERTICES,
    JOB_PRIMITIVES,
    JOB_UNITS,  # of the coordinates
    JOB_ROWS,  # of the units' table
    JOB_MEMBERS,
    JOB_BANDS,
    JOB_OPERATIONS,  # of the combiner plan
    JOB_UNIT_PATH,  # of each unit: codes.PATH_...
) = range(23)
JOB_LOG2_S = JOB_UNIT_PATH + 4
JOB_LOG2_T = JOB_LOG2_S + 4
JOB_COORDINATES_OF = JOB_LOG2_T + 4  # the first unit with the same texel coordinates
JOB_COMPONENTS = JOB_COORDINATES_OF + 4  # coordinates that it iterates, bits 1, 2, 4, 8 for s, t, r, q
JOB_PAIRS = JOB_COMPONENTS + 4  # textures as row pairs
JOB_PAIR_COUNT = JOB_PAIRS + 4
JOB_ADDRESS = JOB_PAIR_COUNT + 4
JOB_SIZE = JOB_ADDRESS + 15
