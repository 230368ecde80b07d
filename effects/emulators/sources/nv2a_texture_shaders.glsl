// Texture shaders: what dot products read, moved coordinates, results and depths: docs/numbers.md, section 12.

const int NV2A_CULL_GEQUAL = 0;
const int NV2A_CULL_LESS = 1;

int nv2a_signed_byte(int v) {
    return v > 127 ? v - 256 : v;
}

int nv2a_signed_word(int v) {
    return v > 32767 ? v - 65536 : v;
}

uvec2 nv2a_int_quotient(int n, int divisor) {
    return nv2a_f64_divide(nv2a_f64_of_int(n), nv2a_f64_of_int(divisor));
}

// Rules dot-mapping-...: (x, y, z) that a dot product reads of a texel.
void nv2a_dot_mapping_unsigned_identity(ivec4 texel, out uvec2 result[3]) {
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_int_quotient(texel[k], 255);
    }
}

void nv2a_dot_mapping_expand_normal(ivec4 texel, out uvec2 result[3]) {
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_int_quotient(texel[k] - 128, 127);
    }
}

void nv2a_dot_mapping_signed_odd(ivec4 texel, out uvec2 result[3]) {
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_int_quotient(2 * nv2a_signed_byte(texel[k]) + 1, 255);
    }
}

void nv2a_dot_mapping_signed_identity(ivec4 texel, out uvec2 result[3]) {
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_int_quotient(nv2a_signed_byte(texel[k]), 127);
    }
}

void nv2a_dot_mapping_unsigned_hilo(ivec4 texel, out uvec2 result[3]) {
    result[0] = nv2a_int_quotient(256 * texel[3] + texel[0], 65535);
    result[1] = nv2a_int_quotient(256 * texel[1] + texel[2], 65535);
    result[2] = uvec2(0x0u, 0x3ff00000u);
}

void nv2a_dot_mapping_signed_hilo_hemisphere(ivec4 texel, out uvec2 result[3]) {
    int x = nv2a_signed_word(256 * texel[3] + texel[0]);
    int y = nv2a_signed_word(256 * texel[1] + texel[2]);
    uint squares = uint(x * x) + uint(y * y);
    uint rest = squares < 0x40000000u ? 0x40000000u - squares : 0u;
    uint root = 0u;
    for (int bit = 15; bit >= 0; bit--) {
        uint more = root | (1u << bit);
        if (more <= 32768u && more * more <= rest) {
            root = more;
        }
    }
    result[0] = nv2a_int_quotient(x, 32767);
    result[1] = nv2a_int_quotient(y, 32767);
    result[2] = nv2a_int_quotient(int(root), 32768);
}

// A shader's real number as a byte.
int nv2a_result_byte(uvec2 v) {
    if (!(nv2a_f64_less(uvec2(0x0u, 0x0u), v) != 0)) {
        v = uvec2(0x0u, 0x0u);
    }
    if (nv2a_f64_less(uvec2(0x0u, 0x3ff00000u), v) != 0) {
        v = uvec2(0x0u, 0x3ff00000u);
    }
    int steps = nv2a_int_of_f64(nv2a_f64_multiply(v, uvec2(0x0u, 0x40b00000u)));
    return nv2a_least(((steps + 1) * 255) >> 12, 255);
}

int nv2a_shader_result_byte(uint v) {
    return nv2a_result_byte(nv2a_f64_of_single(v));
}

// The sum of three terms, each cut to the 24 bits of the largest.
uvec2 nv2a_cut_sum(uvec2 terms[3]) {
    int bound = -99;
    for (int k = 0; k < 3; k++) {
        if (!(nv2a_f64_is_finite(terms[k]) != 0)) {
            return uvec2(0x0u, 0x7ff80000u);
        }
        if (!(nv2a_f64_is_zero(terms[k]) != 0)) {
            bound = nv2a_most(bound, nv2a_f64_bound(terms[k]));
        }
    }
    uvec2 total = uvec2(0u, 0u);
    for (int k = 0; k < 3; k++) {
        total = nv2a_u64_add(total, nv2a_f64_in_units(terms[k], bound - 24));
    }
    return nv2a_f64_of_units(total, bound - 24, 53);
}

// Rule offset-texture: s and t moved by a texel of signed blue and green.
void nv2a_offset_texture(uvec2 st, ivec4 texel, uvec4 matrix, out uvec2 result[2]) {
    uvec2 ds = nv2a_int_quotient(nv2a_signed_byte(texel[2]), 128);
    uvec2 dt = nv2a_int_quotient(nv2a_signed_byte(texel[1]), 128);
    for (int k = 0; k < 2; k++) {
        uvec2 terms[3] = uvec2[3](uvec2(0x0u, 0x0u), uvec2(0x0u, 0x0u), uvec2(0x0u, 0x0u));
        terms[0] = nv2a_f64_of_single(st[k]);
        terms[1] = nv2a_f64_multiply(nv2a_f64_of_single(matrix[k]), ds);
        terms[2] = nv2a_f64_multiply(nv2a_f64_of_single(matrix[k + 2]), dt);
        result[k] = nv2a_cut_sum(terms);
    }
}

// Rule offset-luminance: a texel's colours by another's red.
void nv2a_offset_luminance(ivec4 texel, int magnitude, uint scale, uint bias, out ivec4 result) {
    uvec2 factor = nv2a_f64_multiply(nv2a_int_quotient(magnitude, 255), nv2a_f64_of_single(scale));
    factor = nv2a_f64_add(factor, nv2a_f64_of_single(bias));
    for (int k = 0; k < 3; k++) {
        uvec2 color = nv2a_f64_multiply(nv2a_f64_of_int(texel[k]), factor);
        result[k] = nv2a_result_byte(nv2a_f64_divide(color, uvec2(0x0u, 0x406fe000u)));
    }
    result[3] = texel[3];
}

// The dot product of three numbers with three singles.
uvec2 nv2a_shader_dot(uvec2 a[3], uvec2 b[3]) {
    uvec2 singles[3];
    for (int k = 0; k < 3; k++) {
        singles[k] = nv2a_f64_to_single(b[k]);
    }
    return nv2a_product_sum(a, singles);
}

// 2 n (n e) - e (n n), of doubles.
void nv2a_reflected(uvec2 n[3], uvec2 e[3], out uvec2 result[3]) {
    uvec2 twice = nv2a_f64_multiply(uvec2(0x0u, 0x40000000u), nv2a_shader_dot(n, e));
    uvec2 square = nv2a_shader_dot(n, n);
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_f64_subtract(nv2a_f64_multiply(n[k], twice), nv2a_f64_multiply(e[k], square));
    }
}

void nv2a_reflection(uvec3 normal, uvec3 eye, out uvec2 result[3]) {
    uvec2 n[3];
    uvec2 e[3];
    for (int k = 0; k < 3; k++) {
        n[k] = nv2a_f64_of_single(normal[k]);
        e[k] = nv2a_f64_of_single(eye[k]);
    }
    nv2a_reflected(n, e, result);
}

// Rule depth-replace: a/b as a word of 24 bits; -1 where the fragment ends.
int nv2a_depth_replace(uint a, uint b) {
    uvec2 z = nv2a_f64_multiply(nv2a_f64_of_single(a), nv2a_reciprocal_of_sum(nv2a_f64_of_single(b)));
    if (nv2a_f64_is_nan(z) != 0 || nv2a_f64_less(z, uvec2(0x0u, 0x0u)) != 0 || nv2a_f64_less(uvec2(0xe0000000u,
        0x416fffffu), z) != 0) {
        return -1;
    }
    return nv2a_int_of_f64(z);
}

// Rule cull-fragment: whether a fragment is kept, by the modes of s, t, r and q.
int nv2a_cull_fragment(uvec4 strq, ivec4 modes) {
    for (int k = 0; k < 4; k++) {
        uint size = strq[k] & 0x7fffffffu;
        int below = int((strq[k] & 0x80000000u) != 0u && size != 0u && size <= 0x7f800000u);
        if (below != 0 != (modes[k] == NV2A_CULL_LESS)) {
            return 0;
        }
    }
    return 1;
}
