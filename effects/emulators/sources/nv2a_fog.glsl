// Fog: a line for each vertex, a table for each pixel: docs/numbers.md, section 9.

// Source: NV097_SET_FOG_MODE.
const int NV2A_FOG_EXP = 0x800;
const int NV2A_FOG_EXP2 = 0x801;
const int NV2A_FOG_LINEAR = 0x2601;

// 255 2^(-j/4) and 255 2^(-j j / 128), to nearest.
const int nv2a_fog_exp_nodes[33] = int[33](255, 214, 180, 152, 128, 107, 90, 76, 64, 54, 45, 38, 32, 27, 23, 19,
    16, 13, 11, 9, 8, 7, 6, 5, 4, 3, 3, 2, 2, 2, 1, 1, 1);

const int nv2a_fog_exp2_nodes[33] = int[33](255, 254, 250, 243, 234, 223, 210, 196, 180, 164, 148, 132, 117, 102,
    88, 75, 64, 53, 44, 36, 29, 23, 19, 15, 11, 9, 7, 5, 4, 3, 2, 1, 1);

// Rules fog-factor-...: the factor of n = floor(4096 v), 0 to 8192, of an iterated value v.
int nv2a_fog_factor_linear(int n) {
    return nv2a_least((nv2a_clamp(n - 4095, 0, 4096) * 255) >> 12, 255);
}

int nv2a_fog_factor_exp(int n) {
    int x = nv2a_most(6144 - n, 0);
    int j = nv2a_least(x >> 6, 31);
    int f = x & 63;
    return x >= 2048 ? 0 : (nv2a_fog_exp_nodes[j] * (64 - f) + nv2a_fog_exp_nodes[j + 1] * f + 32) >> 6;
}

int nv2a_fog_factor_exp_abs(int n) {
    return nv2a_fog_factor_exp(n > 6144 ? 12288 - n : n);
}

int nv2a_fog_factor_exp2(int n) {
    int x = n > 6144 ? n - 6144 : 6144 - n;
    int j = nv2a_least(x >> 6, 31);
    int f = x & 63;
    return x >= 2048 ? 0 : (nv2a_fog_exp2_nodes[j] * (64 - f) + nv2a_fog_exp2_nodes[j + 1] * f + 32) >> 6;
}

// n of an iterated value.
int nv2a_fog_steps(uvec2 v) {
    return nv2a_clamp(nv2a_floor_of_f64(nv2a_f64_multiply(v, uvec2(0x0u, 0x40b00000u))), 0, 8192);
}

// Rule fog-line: the value of a vertex.
uvec2 nv2a_fog_line(int mode, uint bias, uint multiplier, uint c) {
    uint entered = nv2a_enter_lighting(c);
    uvec2 value;
    if (mode == NV2A_FOG_LINEAR) {
        value = uvec2(0x0u, 0x7ff00000u);
        if (nv2a_is_finite(entered) != 0) {
            value = nv2a_f64_of_single(nv2a_unit_product(entered, nv2a_flushed(multiplier), 24));
        }
        value = nv2a_f64_add(value, nv2a_f64_of_single(nv2a_flushed(bias)));
        value = nv2a_f64_multiply(value, uvec2(0x0u, 0x41400000u));
        value = nv2a_f64_negated(nv2a_f64_floor(nv2a_f64_negated(value)));
        value = nv2a_f64_multiply(nv2a_f64_add(value, uvec2(0x0u, 0x0u)), uvec2(0x0u, 0x3ea00000u));
    } else {
        uint product = nv2a_lighting_product(entered, nv2a_enter_lighting(multiplier));
        value = nv2a_f64_of_single(nv2a_lighting_sum(product, nv2a_enter_lighting(bias), 0u));
    }
    uvec2 largest = uvec2(0x0u, 0x47e00000u);
    if (nv2a_f64_is_nan(value) != 0 || nv2a_f64_less(largest, value) != 0) {
        return largest;
    }
    return nv2a_f64_less(value, nv2a_f64_negated(largest)) != 0 ? nv2a_f64_negated(largest) : value;
}

// Rule fog-blend: a colour's component, by the factor.
int nv2a_fog_blend(int f, int color, int fog) {
    return nv2a_rn(f * color + (255 - f) * fog);
}
