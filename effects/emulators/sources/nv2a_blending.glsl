// Blending, logic operations, and what surfaces keep: docs/numbers.md, N10.3 to N10.5.

// Source: NV097_SET_BLEND_FUNC_SFACTOR: OpenGL's numbers.
const int NV2A_FACTOR_ZERO = 0;
const int NV2A_FACTOR_ONE = 1;
const int NV2A_FACTOR_SRC_COLOR = 0x300;
const int NV2A_FACTOR_ONE_MINUS_SRC_COLOR = 0x301;
const int NV2A_FACTOR_DST_COLOR = 0x306;
const int NV2A_FACTOR_ONE_MINUS_DST_COLOR = 0x307;
const int NV2A_FACTOR_SRC_ALPHA = 0x302;
const int NV2A_FACTOR_ONE_MINUS_SRC_ALPHA = 0x303;
const int NV2A_FACTOR_DST_ALPHA = 0x304;
const int NV2A_FACTOR_ONE_MINUS_DST_ALPHA = 0x305;
const int NV2A_FACTOR_SRC_ALPHA_SATURATE = 0x308;
const int NV2A_FACTOR_CONSTANT_COLOR = 0x8001;
const int NV2A_FACTOR_ONE_MINUS_CONSTANT_COLOR = 0x8002;
const int NV2A_FACTOR_CONSTANT_ALPHA = 0x8003;
const int NV2A_FACTOR_ONE_MINUS_CONSTANT_ALPHA = 0x8004;

// Source: NV097_SET_BLEND_EQUATION.
const int NV2A_EQUATION_FUNC_ADD = 0x8006;
const int NV2A_EQUATION_MIN = 0x8007;
const int NV2A_EQUATION_MAX = 0x8008;
const int NV2A_EQUATION_FUNC_SUBTRACT = 0x800a;
const int NV2A_EQUATION_FUNC_REVERSE_SUBTRACT = 0x800b;
const int NV2A_EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED = 0xf005;
const int NV2A_EQUATION_FUNC_ADD_SIGNED = 0xf006;

// Source: NV097_SET_LOGIC_OP: OpenGL's numbers.
const int NV2A_LOGIC_CLEAR = 0x1500;
const int NV2A_LOGIC_AND = 0x1501;
const int NV2A_LOGIC_AND_REVERSE = 0x1502;
const int NV2A_LOGIC_COPY = 0x1503;
const int NV2A_LOGIC_AND_INVERTED = 0x1504;
const int NV2A_LOGIC_NOOP = 0x1505;
const int NV2A_LOGIC_XOR = 0x1506;
const int NV2A_LOGIC_OR = 0x1507;
const int NV2A_LOGIC_NOR = 0x1508;
const int NV2A_LOGIC_EQUIV = 0x1509;
const int NV2A_LOGIC_INVERT = 0x150a;
const int NV2A_LOGIC_OR_REVERSE = 0x150b;
const int NV2A_LOGIC_COPY_INVERTED = 0x150c;
const int NV2A_LOGIC_OR_INVERTED = 0x150d;
const int NV2A_LOGIC_NAND = 0x150e;
const int NV2A_LOGIC_SET = 0x150f;

// Rules blend-factor-...: of a source s, a destination d and the constant, each red, green, blue, alpha.
void nv2a_blend_factor_zero(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 0;
    }
}

void nv2a_blend_factor_one(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255;
    }
}

void nv2a_blend_factor_src_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = s[k];
    }
}

void nv2a_blend_factor_one_minus_src_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - s[k];
    }
}

void nv2a_blend_factor_dst_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = d[k];
    }
}

void nv2a_blend_factor_one_minus_dst_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - d[k];
    }
}

void nv2a_blend_factor_src_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = s[3];
    }
}

void nv2a_blend_factor_one_minus_src_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - s[3];
    }
}

void nv2a_blend_factor_dst_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = d[3];
    }
}

void nv2a_blend_factor_one_minus_dst_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - d[3];
    }
}

void nv2a_blend_factor_src_alpha_saturate(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = k == 3 ? 255 : nv2a_least(s[3], 255 - d[3]);
    }
}

void nv2a_blend_factor_constant_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = constant[k];
    }
}

void nv2a_blend_factor_one_minus_constant_color(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - constant[k];
    }
}

void nv2a_blend_factor_constant_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = constant[3];
    }
}

void nv2a_blend_factor_one_minus_constant_alpha(ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = 255 - constant[3];
    }
}

// The factor that NV097_SET_BLEND_FUNC_SFACTOR or _DFACTOR chooses.
void nv2a_blend_factor(int factor, ivec4 s, ivec4 d, ivec4 constant, out ivec4 result) {
    nv2a_blend_factor_zero(s, d, constant, result);
    if (factor == NV2A_FACTOR_ONE) {
        nv2a_blend_factor_one(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_SRC_COLOR) {
        nv2a_blend_factor_src_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_SRC_COLOR) {
        nv2a_blend_factor_one_minus_src_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_DST_COLOR) {
        nv2a_blend_factor_dst_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_DST_COLOR) {
        nv2a_blend_factor_one_minus_dst_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_SRC_ALPHA) {
        nv2a_blend_factor_src_alpha(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_SRC_ALPHA) {
        nv2a_blend_factor_one_minus_src_alpha(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_DST_ALPHA) {
        nv2a_blend_factor_dst_alpha(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_DST_ALPHA) {
        nv2a_blend_factor_one_minus_dst_alpha(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_SRC_ALPHA_SATURATE) {
        nv2a_blend_factor_src_alpha_saturate(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_CONSTANT_COLOR) {
        nv2a_blend_factor_constant_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_CONSTANT_COLOR) {
        nv2a_blend_factor_one_minus_constant_color(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_CONSTANT_ALPHA) {
        nv2a_blend_factor_constant_alpha(s, d, constant, result);
    }
    if (factor == NV2A_FACTOR_ONE_MINUS_CONSTANT_ALPHA) {
        nv2a_blend_factor_one_minus_constant_alpha(s, d, constant, result);
    }
}

// Rules blend-...: one component, by its factors.
int nv2a_blend_func_add(int s, int fs, int d, int fd) {
    return nv2a_clamp(nv2a_rn(s * fs + d * fd), 0, 255);
}

int nv2a_blend_func_subtract(int s, int fs, int d, int fd) {
    return nv2a_clamp(nv2a_rn(s * fs - d * fd), 0, 255);
}

int nv2a_blend_func_reverse_subtract(int s, int fs, int d, int fd) {
    return nv2a_clamp(nv2a_rn(d * fd - s * fs), 0, 255);
}

int nv2a_blend_min(int s, int fs, int d, int fd) {
    return nv2a_least(s, d);
}

int nv2a_blend_max(int s, int fs, int d, int fd) {
    return nv2a_most(s, d);
}

int nv2a_blend_func_add_signed(int s, int fs, int d, int fd) {
    return nv2a_clamp(s > 127 ? d + s - 256 : d + s, 0, 255);
}

int nv2a_blend_func_reverse_subtract_signed(int s, int fs, int d, int fd) {
    return nv2a_clamp(s > 127 ? d - s + 256 : d - s, 0, 255);
}

// The equation that NV097_SET_BLEND_EQUATION chooses, of one component.
int nv2a_blend_equation(int equation, int s, int fs, int d, int fd) {
    if (equation == NV2A_EQUATION_FUNC_SUBTRACT) {
        return nv2a_blend_func_subtract(s, fs, d, fd);
    }
    if (equation == NV2A_EQUATION_FUNC_REVERSE_SUBTRACT) {
        return nv2a_blend_func_reverse_subtract(s, fs, d, fd);
    }
    if (equation == NV2A_EQUATION_MIN) {
        return nv2a_blend_min(s, fs, d, fd);
    }
    if (equation == NV2A_EQUATION_MAX) {
        return nv2a_blend_max(s, fs, d, fd);
    }
    if (equation == NV2A_EQUATION_FUNC_ADD_SIGNED) {
        return nv2a_blend_func_add_signed(s, fs, d, fd);
    }
    if (equation == NV2A_EQUATION_FUNC_REVERSE_SUBTRACT_SIGNED) {
        return nv2a_blend_func_reverse_subtract_signed(s, fs, d, fd);
    }
    return nv2a_blend_func_add(s, fs, d, fd);
}

// A source blended with a destination, by the chip's numbers of the equation and the two factors.
void nv2a_blend(int equation, int source_factor, int destination_factor, ivec4 s, ivec4 d, ivec4 constant,
    out ivec4 result) {
    ivec4 fs;
    ivec4 fd;
    nv2a_blend_factor(source_factor, s, d, constant, fs);
    nv2a_blend_factor(destination_factor, s, d, constant, fd);
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_blend_equation(equation, s[k], fs[k], d[k], fd[k]);
    }
}

// Rule logic-operation: of a byte each.
int nv2a_logic_operation(int operation, int s, int d) {
    int table = operation - NV2A_LOGIC_CLEAR;
    int found = 0;
    if ((table & 1) != 0) {
        found = found | (s & d);
    }
    if ((table & 2) != 0) {
        found = found | (s & ~d);
    }
    if ((table & 4) != 0) {
        found = found | (~s & d);
    }
    if ((table & 8) != 0) {
        found = found | (~s & ~d);
    }
    return found & 255;
}

// Colours cut to so many bits, and the alpha's byte: a word, red the lowest byte.
uint nv2a_kept(ivec4 color, int red, int green, int blue, int alpha) {
    uint r = uint(color[0] >> (8 - red) << (8 - red));
    uint g = uint(color[1] >> (8 - green) << (8 - green));
    uint b = uint(color[2] >> (8 - blue) << (8 - blue));
    return r | (g << 8) | (b << 16) | (uint(alpha) << 24);
}

// Rules surface-...: what a colour format keeps of a fragment.
uint nv2a_surface_a8r8g8b8(ivec4 color) {
    return nv2a_kept(color, 8, 8, 8, color[3]);
}

uint nv2a_surface_x8r8g8b8_z8r8g8b8(ivec4 color) {
    return nv2a_kept(color, 8, 8, 8, 0);
}

uint nv2a_surface_x8r8g8b8_o8r8g8b8(ivec4 color) {
    return nv2a_kept(color, 8, 8, 8, 255);
}

uint nv2a_surface_x1a7r8g8b8_z1a7r8g8b8(ivec4 color) {
    return nv2a_kept(color, 8, 8, 8, color[3] >> 1);
}

uint nv2a_surface_x1a7r8g8b8_o1a7r8g8b8(ivec4 color) {
    return nv2a_kept(color, 8, 8, 8, 128 | (color[3] >> 1));
}

uint nv2a_surface_r5g6b5(ivec4 color) {
    return nv2a_kept(color, 5, 6, 5, 0);
}

uint nv2a_surface_x1r5g5b5_z1r5g5b5(ivec4 color) {
    return nv2a_kept(color, 5, 5, 5, 0);
}

uint nv2a_surface_x1r5g5b5_o1r5g5b5(ivec4 color) {
    return nv2a_kept(color, 5, 5, 5, 128);
}
