"""Layout of the rows that kernels read: ``pipeline/native/`` writes them, and ``pipeline/vertices/`` those of
lines. Every entry is an integer unless it says so.

A state is packed so that two states that cannot differ in their result give equal rows: what is disabled is
zero.
"""

from fixedpipe.raster.codes import REGISTER_DISCARD


class _Row:
    """Hands out a row's places in order: ``row()`` is the next, ``row(n)`` the first of the next n."""

    def __init__(self, first=0):
        self.size = first

    def __call__(self, width=1):
        place, self.size = self.size, self.size + width
        return place


# ------------------------------------------------------------------ draw: int64[DRAW_SIZE]
STENCIL_OPERATION_SIZE = 5  # and, xor, add, low, high: clamp(((s & and) ^ xor) + add, low, high) & 255
PIXEL_WIDE = 8  # a LINE_WIDTH of one pixel
BITS_OF_BYTES, MOST_BITS = 8, 12  # of components: what vectors and packed words take, and what columns do
MAX_CLIP_RECTANGLES = 8
MAX_COVER_SAMPLES = 8
_draw = _Row()
X0 = _draw()  # device pixels, half open: the screen cut by the scissor box
Y0 = _draw()
X1 = _draw()
Y1 = _draw()
CULL_POSITIVE = _draw()  # cull triangles whose area is positive
CULL_NEGATIVE = _draw()
BACK_SIGN = _draw()  # 0: all front; 1: A > 0 takes the back colour; -1: A < 0 does
FLAT = _draw()  # codes.COLORS_...; 0: they are iterated
DEPTH_FORMAT = _draw()  # codes.DEPTH_...
DEPTH_MAX = _draw()  # fixed: 2**bits - 1
DEPTH_CULL = _draw()  # 1: a depth outside its limits ends the fragment; 0: it is clamped
W_BUFFERING = _draw()
POLYGON_OFFSET = _draw()
OFFSET_FRACTION = _draw()  # 1: a fixed format's offset keeps its fraction
NEEDS_COLOR = _draw()  # 0: no colour is written and no alpha test looks at it
NEEDS_PRIMARY = _draw()
NEEDS_SECONDARY = _draw()
NEEDS_COLOR_WEIGHTS = _draw()  # codes.WEIGHTS_...; 0: none
NEEDS_ITERATION_WEIGHTS = _draw()  # weights with 24 significant bits: those, or texture coordinates
NEEDS_WEIGHTS = _draw()  # full-precision weights
NEEDS_DEPTH = _draw()
UNITS = _draw()
YCBCR = _draw()  # 1: texture units' registers hold Y, Cb and Cr, and become RGB
BITS = _draw()  # of fragments' colours, as combiners compute them
BUFFER_BITS = _draw()  # of the color buffer's components: 8, four bytes in a word; else a word for each
DIRECT = _draw()  # 1: the fragment is its primary colour, no combiners
STAGES = _draw()
COLOR_SUM = _draw()  # bits: codes.COLOR_SUM_...
USES_E_TIMES_F = _draw()
USES_SPARE0_PLUS_SECONDARY = _draw()
WRITES_TEXTURE = _draw()  # 1: a stage writes a disabled unit's register; each batch must find it unset
STAGE_CONSTANTS = _draw()  # 1: constants change from stage to stage
FOG_ENABLED = _draw()  # codes.FOG_BY_...: thresholds, or a table of floor(4096 v); 0: no fog
FOG_RISING = _draw()  # 1: the factor grows with the coordinate
FOG_RED = _draw()  # the colour in units of BITS
FOG_GREEN = _draw()
FOG_BLUE = _draw()
ALPHA_TEST = _draw()
ALPHA_FUNCTION = _draw()  # codes.COMPARISON_..., as every function here
ALPHA_REFERENCE = _draw()  # in units of BUFFER_BITS
STENCIL_TEST = _draw()
STENCIL_FUNCTION = _draw()
STENCIL_REFERENCE = _draw()
STENCIL_MASK = _draw()
STENCIL_WRITE_MASK = _draw()
STENCIL_FAIL = _draw(STENCIL_OPERATION_SIZE)
STENCIL_DEPTH_FAIL = _draw(STENCIL_OPERATION_SIZE)
STENCIL_DEPTH_PASS = _draw(STENCIL_OPERATION_SIZE)
DEPTH_FUNCTION = _draw()
DEPTH_WRITE = _draw()
BLEND = _draw()  # codes.BLEND_...
BLEND_EQUATION = _draw()  # codes.EQUATION_...
LOGIC_OPERATION = _draw()  # codes.LOGIC_...
COLOR_MASK = _draw()  # 32 bits, as stored in bytes
TEXTURE_SHADER = _draw()  # 1: stages read earlier stages' texels
DISCARDS = _draw()  # 1: shading may discard fragments
SURFACE = _draw()  # 1: not four bytes, or a signed blend equation: through the three that follow
SURFACE_KEEP = _draw()  # 32 bits, as stored: those that the surface's format keeps
SURFACE_PAD = _draw()  # 32 bits: those that are always one
SURFACE_ALPHA = _draw()  # as a factor: codes.SURFACE_ALPHA_...
STROKES = _draw()  # 1: some primitives are no triangles
LINE_WIDTH = _draw()  # 1/8 pixel
LINE_STEPS = _draw()  # codes.LINE_...
OFFSET_LINE = _draw()  # polygon offset, of polygons drawn as lines and as points
OFFSET_POINT = _draw()
COVERAGE = _draw()  # bit 1 << codes.PRIMITIVE_...: what draws a pixel by the samples below, not by its middle
COVER_SAMPLES = _draw()  # how many; the fragment's alpha is multiplied with the share that is covered
COVER_SAMPLE = _draw(2 * MAX_COVER_SAMPLES)  # of each x and y, 1/16 pixel from the middle, y down
STIPPLE = _draw()
STIPPLE_WORD = _draw(32)  # words, device row 0 first, the leftmost pixel in the highest bit
LINE_FACTOR = _draw()  # line stipple: how often each bit is used; 0: none
LINE_PATTERN = _draw()  # 16 bits, the first in the lowest
WINDOW_CLIP = _draw()  # codes.WINDOW_CLIP_...
CLIP_RECTANGLES = _draw()
CLIP_RECTANGLE = _draw(4 * MAX_CLIP_RECTANGLES)  # of each left, top, right, bottom: device pixels, half open
DRAW_SIZE = _draw.size

# -------- strokes: int32[primitives, STROKE_SIZE], or none: kind (codes.PRIMITIVE_...), takes the back
# colour, three source vertices; of a line in steps the first pixel along its longer axis and the one behind
# the last, and the line stipple's counter at the first.
KIND, BACK, SOURCE = range(3)
FIRST_STEP, END_STEP, COUNTER, STROKE_SIZE = range(5, 9)

# ---------------------------- blend factors: int32[2, 4 * FACTOR_SIZE]: source, destination; red, green,
# blue, alpha masks of S, D, As, Ad and the saturate term; a constant; xor (the value of one: one minus)
FACTOR_SIZE = 7

# ------------------------------------------------------------ draw: float64[DRAW_FLOAT_SIZE]
DEPTH_LOW, DEPTH_HIGH, OFFSET_FACTOR, OFFSET_UNITS, DRAW_FLOAT_SIZE = range(5)

# ------------------------------------------- general combiner portions: int32[stages, 2, PORTION_SIZE]
# Four inputs of INPUT_SIZE entries: register, usage (codes.REGISTER_..., USAGE_...), and the mapping as
# min(max(x, low) * factor + addend, one).
INPUT_SIZE = 5
_portion = _Row(4 * INPUT_SIZE)
AB_OUTPUT = _portion()
CD_OUTPUT = _portion()
SUM_OUTPUT = _portion()
AB_DOT = _portion()
CD_DOT = _portion()
MUX = _portion()  # the bit of SPARE0's alpha that selects, its highest or 1; 0: a sum
BIAS = _portion()
SCALE = _portion()  # codes.SCALE_...
AB_BLUE = _portion()  # 1: blue goes to the output's alpha as well
CD_BLUE = _portion()
PORTION_SIZE = _portion.size

# -------------------------------------- final combiner: int32[7, FINAL_SIZE]: register, usage, invert
FINAL_SIZE = 3

# --------------------------------------------------------------- units: int64[units, UNIT_SIZE]
_unit = _Row()
ENABLED = _unit()
TARGET = _unit()  # codes.TARGET_...
LEVELS = _unit()
WRAP_S = _unit()  # codes.WRAP_..., as WRAP_T and WRAP_R
WRAP_T = _unit()
MAG_LINEAR = _unit()
MIN_LINEAR = _unit()  # within a level
MIPMAP = _unit()  # codes.MIPMAP_...
LOD_BIAS = _unit()  # 8 fraction bits
THRESHOLD = _unit()  # lambda up to which the texture is magnified, 8 fraction bits
TEXEL_BITS = _unit()  # of a texel's components: 8, or wider and in two words (``portable.texels``)
BORDER = _unit(2)  # packed RGBA: a word, or two
PROJECTIVE = _unit()  # 1: divide by q
WRAP_R = _unit()
LAYERS = _unit()  # of level 0 of a 3D texture
MIN_LOD = _unit()  # 8 fraction bits, as MAX_LOD
MAX_LOD = _unit()
SIGNED = _unit()  # packed: 0x80 in each signed component, whose texels and border come with that bit inverted
OPERATION = _unit()  # codes.OPERATION_...; 0: the unit samples its texture
PREVIOUS = _unit()  # previous texture input
ROUGHNESS = _unit()  # 1 + the unit whose texel is the roughness that filters the lookup; 0: nothing does
MAPPING = _unit()  # codes.DOT_MAPPING_...
CULL_MODES = _unit()  # bit k: coordinate k's codes.CULL_MODE_...
COMPARE = _unit()  # codes.COMPARE_MODE_...
COMPARE_FUNCTION = _unit()
COMPARE_HELD = _unit()  # packed: what takes a texel's place where the comparison holds
COMPARE_FAILED = _unit()
HILO = _unit()  # 1: texels are two words of 16 bits, alpha and red, green and blue
COLORLESS = _unit()  # 1: the register receives (0, 0, 0, 0), later stages the texel
DEPTH_TEXEL_MAX = _unit()  # the largest depth word of a compared texture
DEPTH_TEXEL_FORMAT = _unit()  # codes.DEPTH_...
ANISOTROPY = _unit()  # the largest ratio, a float64's bit pattern; 0: isotropic
PROBES = _unit()  # the most probes of a footprint, 16 at most; 0: none are assembled
EXACT_PROBES = _unit()  # 1: as many of them as cover it; 0: a power of two
OFFSET_MATRIX = _unit(4)  # this and those that follow are bit patterns of float64
OFFSET_SCALE = _unit()
OFFSET_BIAS = _unit()
OFFSET_LARGEST = _unit()  # the largest factor of a scaled texel
CONSTANT_EYE = _unit(3)
ROUGHNESS_SCALE = _unit()
COORDINATE_DEPTH = _unit()  # depth units for one unit of a coordinate that is a depth
UNIT_SIZE = _unit.size

# ------------------------------ texture levels: int32[units, MAX_LEVELS, 3]: offset, width, height
MAX_UNITS = 4
MAX_LEVELS = 16  # the ideal profile's largest texture, 2**14 texels an edge, has 15

REGISTERS = REGISTER_DISCARD  # those before it have four planes each: red, green, blue, alpha

# ------------------------------------- scratch columns of a batch: floats float64[FLOAT_COLUMNS, batch]
_floats = _Row()
S = _floats()  # texture coordinates; for a cube map, of its face, doubled
T = _floats()
Q0 = _floats()  # weights of vertices 0 and 2 with 24 significant bits
Q2 = _floats()
S_SIZE = _floats()  # sizes of each fragment's level
T_SIZE = _floats()
TEXEL = _floats()  # a texel coordinate
EXTRA = _floats()  # a cube map's r, or q
B0 = _floats()  # weights of vertices 0 and 2
B2 = _floats()
P = _floats()  # a 3D texture's r
P_SIZE = _floats()
COORDINATE0 = _floats(4)  # coordinates of a texture shader stage
DOT0 = _floats(4)  # the stages' dot products
DEPTH = _floats()  # before it is a word
CENTER_S = _floats()  # of anisotropic filters: a fragment's own S and T
CENTER_T = _floats()
ALONG_S = _floats()  # its footprint's longer side
ALONG_T = _floats()
RATIO = _floats()  # how much longer that is, or how many probes it takes
FLOAT_COLUMNS = _floats.size
# ints int32[INT_COLUMNS, batch]
_ints = _Row()
FACE = _ints()  # of a cube map
BASE = _ints()  # where the level begins
WIDTH = _ints()  # and its width
I0 = _ints()  # neighbouring columns
I1 = _ints()
I_FRACTION = _ints()
J0 = _ints()  # neighbouring rows
J1 = _ints()
J_FRACTION = _ints()
LEVEL = _ints()
FRACTION = _ints()  # between levels
LOD = _ints()  # lambda
W0 = _ints()  # colour weights
W2 = _ints()
OWNER = _ints()  # the triangle of a run
K0 = _ints()  # neighbouring layers
K1 = _ints()
K_FRACTION = _ints()
REFERENCE = _ints()  # the depth word that texels are compared with
COVERED = _ints()  # how many samples of a fragment's pixel its primitive covers
INT_COLUMNS = _ints.size
# packed uint32[PACKED_COLUMNS, batch]
_packed = _Row()
P00 = _packed()  # the four texels of a linear filter
P10 = _packed()
P01 = _packed()
P11 = _packed()
TEXEL_0 = _packed()  # filtered texels
TEXEL_1 = _packed()
MAGNIFIED = _packed()
LAYER_1 = _packed()  # the upper layer's
STAGE0 = _packed(4)  # the texel of each texture shader stage
SUM_EVEN = _packed()  # an anisotropic filter's sums of bytes 0 and 2
SUM_ODD = _packed()  # of bytes 1 and 3
WIDE = _packed.size  # as many columns again: the second words of wide texels
PACKED_COLUMNS = 2 * WIDE
# lists int32[LISTS, batch + 1]: segments and runs of a batch (``fixedpipe.raster.arrays``). In the vector
# engine a run with RUN_Y -1 is a mixed segment, and SINGLE is 1 where a segment's weights are singles.
STARTS, OWNERS, BACKS, RUN_STARTS, RUN_X, RUN_Y, SINGLE, LISTS = range(8)

# ----------------------------------------------------------------- the vector engine (raster/vector/frame.py)
SLACK = 32  # elements of every column behind a batch: vectors may reach so far

# More columns of floats: what fragments of mixed segments carry of their triangle.
_floats = _Row(FLOAT_COLUMNS)
N0 = _floats()  # edge functions
N1 = _floats()
N2 = _floats()
WEIGHT_FACTOR0 = _floats()  # what edge functions are multiplied with, or the area's reciprocal
WEIGHT_FACTOR1 = _floats()
WEIGHT_FACTOR2 = _floats()
Z0 = _floats()  # depths of the vertices, and their differences
Z1 = _floats()
Z2 = _floats()
Z10 = _floats()
Z20 = _floats()
Z21 = _floats()
Z_RECIPROCAL = _floats()  # of the area, for depths
Z_OFFSET = _floats()  # polygon offset
TERMS = _floats(12 * 4)  # of each unit, for s, t, r, q: vertex 1's, and how far vertices 0 and 2 are from it
VECTOR_FLOAT_COLUMNS = _floats.size
# singles float32[SINGLE_COLUMNS, batch]: weights of vertices 0 and 2, what weights are made of in blocks, and
# coordinates s, t, r, q (one alone lies in the first).
SINGLE_Q0, SINGLE_Q2, PART0, PART1, PART2, PARTS, SINGLE_COORDINATE = range(7)
SINGLE_COLUMNS = SINGLE_COORDINATE + 4
# More columns of ints.
_ints = _Row(INT_COLUMNS)
FIXED0 = _ints(2 * 4)  # floor(256 u size) of s and t of each unit
PIXEL = _ints()  # y * width + x of each fragment of a mixed segment
DEPTH_WORD = _ints()
DEPTH_NUMBERS = _ints()  # of the triangle whose depths are made (``fixedpipe.raster.vector.single_depths``)
VECTOR_INT_COLUMNS = _ints.size
# lanes int32[LANES, 16]: small triangles that are set up together
# (``fixedpipe.raster.vector.small_triangles``).
_lanes = _Row()
LANE_X0 = _lanes()  # corners, 1/16 pixel
LANE_Y0 = _lanes()
LANE_X1 = _lanes()
LANE_Y1 = _lanes()
LANE_X2 = _lanes()
LANE_Y2 = _lanes()
LANE_LEFT = _lanes()  # the box's first column and row
LANE_ROW = _lanes()
LANE_UPPER = _lanes()  # bit 8 * row + column: that pixel of the box is covered
LANE_LOWER = _lanes()  # the same from the box's fifth row on
LANE_SIGN = _lanes()  # of the area, and its amount
LANE_AREA = _lanes()
LANE_N0 = _lanes()  # edge functions at the box's first pixel, and their steps
LANE_N1 = _lanes()
LANE_N2 = _lanes()
LANE_RIGHT0 = _lanes()
LANE_RIGHT1 = _lanes()
LANE_RIGHT2 = _lanes()
LANE_DOWN0 = _lanes()
LANE_DOWN1 = _lanes()
LANE_DOWN2 = _lanes()
LANES = _lanes.size
# More planes behind the registers: base and two differences of each colour channel in mixed segments.
SPARE_PLANES = 24  # for what combiners compute
COLOR_TERMS = REGISTERS * 4 + SPARE_PLANES
VECTOR_PLANES = COLOR_TERMS + 3 * 8
# More columns of packed: the fragments' colours.
SHADED, VECTOR_PACKED_COLUMNS = WIDE, WIDE + 1
# jobs int64[n, arrays.JOB_SIZE]: what a queued command is.
_job = _Row()
JOB_KIND = _job()  # codes.JOB_...
JOB_X0 = _job()  # device pixels, half open
JOB_Y0 = _job()
JOB_X1 = _job()
JOB_Y1 = _job()
JOB_BUFFERS = _job()  # of a Clear: codes.BUFFER_...; values and masks as stored
JOB_COLOR = _job()
JOB_COLOR_MASK = _job()
JOB_DEPTH = _job()
JOB_STENCIL = _job()
JOB_STENCIL_MASK = _job()
JOB_ROW_RUNS = _job()  # 1: every row of a small triangle is a run (lambda and records need them)
JOB_RECORDED = _job()  # 1: which fragments it has, and which passed, is recorded
JOB_USABLE = _job()  # 1: what the units read lies inside their row pairs
JOB_PERSPECTIVE = _job()  # 1: some 1/w differ
JOB_ONE_COLOR = _job()  # 1: no vertex has colours of its own
JOB_OF_COLORS = _job()  # 1: weights are needed for colours alone, and not in perspective
JOB_UNIT_PATH = _job(4)  # of each unit: codes.PATH_...
JOB_LOG2_S = _job(4)
JOB_LOG2_T = _job(4)
JOB_COORDINATES_OF = _job(4)  # the first unit with the same texel coordinates
JOB_COMPONENTS = _job(4)  # coordinates that it iterates, bits 1, 2, 4, 8 for s, t, r, q
JOB_ARRAYS = _job.size  # addresses and shapes of a Draw's arrays (``fixedpipe.raster.vector.addresses``)
