// Vertex programs' instructions: docs/numbers.md, N2.13, N2.23 and N2.24. A register is four singles.

// A single as a unit reads it: denormal numbers are zeros that keep their sign.
uint nv2a_flushed(uint x) {
    return (x & 0x7f800000u) == 0u ? x & 0x80000000u : x;
}

int nv2a_is_nan(uint x) {
    return int((x & 0x7fffffffu) > 0x7f800000u);
}

int nv2a_is_infinite(uint x) {
    return int((x & 0x7fffffffu) == 0x7f800000u);
}

int nv2a_is_finite(uint x) {
    return int((x & 0x7f800000u) != 0x7f800000u);
}

// Whether a unit reads it as zero.
int nv2a_is_zero(uint x) {
    return int((x & 0x7f800000u) == 0u);
}

// The single of m 2^e cut toward zero to so many bits, with a sign bit: 0 below 2^-126, and above single precision's
// range the largest number of these bits.
uint nv2a_packed(uint sign, uvec2 m, int e, int bits) {
    int top = nv2a_top_bit_64(m);
    int field = e + top + 127;
    uint mask = (0xffffffffu << (24 - bits)) & 0x7fffffu;
    uint fraction = nv2a_u64_right(nv2a_u64_left(m, 63 - top), 40).x & mask;
    uint found = (uint(nv2a_clamp(field, 0, 254)) << 23) | (field > 254 ? mask : fraction);
    return m == uvec2(0x0u, 0x0u) || field < 1 ? 0u : sign | found;
}

// a b of finite numbers, cut to so many bits.
uint nv2a_finite_product(uint a, uint b, int bits) {
    if (nv2a_is_zero(a) != 0 || nv2a_is_zero(b) != 0) {
        return 0u;
    }
    uint ma = (a & 0x7fffffu) | 0x800000u;
    uint mb = (b & 0x7fffffu) | 0x800000u;
    int e = int((a >> 23) & 255u) + int((b >> 23) & 255u) - 300;
    return nv2a_packed((a ^ b) & 0x80000000u, nv2a_u32_product(ma, mb), e, bits);
}

// |x| in units of 2^(field - 126 - bits - guard), cut toward zero, with the sign of x.
int nv2a_term(uint x, int field, int bits, int guard) {
    if (nv2a_is_zero(x) != 0) {
        return 0;
    }
    uint m = (x & 0x7fffffu) | 0x800000u;
    int down = field - int((x >> 23) & 255u) + 24 - bits - guard;
    m = down > 31 ? 0u : down < 0 ? m << -down : m >> down;
    return (x & 0x80000000u) != 0u ? -int(m) : int(m);
}

// The sum of four finite numbers: each is cut so many guard bits below the last of the largest's bits.
uint nv2a_finite_sum(uvec4 x, int bits, int guard) {
    int field = 0;
    for (int k = 0; k < 4; k++) {
        field = nv2a_most(field, int((x[k] >> 23) & 255u));
    }
    int sum = 0;
    for (int k = 0; k < 4; k++) {
        sum += nv2a_term(x[k], field, bits, guard);
    }
    uint sign = sum < 0 ? 0x80000000u : 0u;
    return nv2a_packed(sign, uvec2(uint(sum < 0 ? -sum : sum), 0u), field - 126 - bits - guard, bits);
}

// The sign and the limits of reciprocals: 1/0 is infinity, 1/infinity is 0.
uint nv2a_with_limits(uint found, uint x) {
    if (nv2a_is_nan(x) != 0) {
        return 0x7fc00000u;
    }
    if (nv2a_is_zero(x) != 0) {
        return 0x7f800000u;
    }
    if (nv2a_is_infinite(x) != 0) {
        return 0u;
    }
    return found;
}

// Rule reciprocal: 1/x in the transform unit.
uint nv2a_reciprocal(uint x) {
    uint m = (x & 0x7fffffu) | 0x800000u;
    uint place = (m >> 17) & 63u;
    int field = int((x >> 23) & 255u);
    uvec2 seed = uvec2((32768u / (129u + 2u * place) + 1u) / 2u, 0u);
    uvec2 better = nv2a_u64_right(nv2a_u64_multiply(nv2a_u64_subtract(nv2a_u64_left(uvec2(0x1u, 0x0u), 31),
        nv2a_u64_multiply(seed, uvec2(m, 0u))), seed), 24);
    uvec2 best = nv2a_u64_right(nv2a_u64_multiply(nv2a_u64_subtract(nv2a_u64_left(uvec2(0x1u, 0x0u), 37),
        nv2a_u64_multiply(better, uvec2(m, 0u))), better), 25);
    if (m == 0x800000u) {
        best = nv2a_u64_left(uvec2(0x1u, 0x0u), 24);
    }
    return nv2a_with_limits(nv2a_packed(x & 0x80000000u, best, 103 - field, 24), x);
}

const int nv2a_root_seeds[128] = int[128](127, 127, 126, 125, 124, 123, 122, 121, 120, 119, 119, 118, 117, 116,
    116, 115, 114, 113, 113, 112, 111, 111, 110, 109, 109, 108, 108, 107, 106, 106, 105, 105, 104, 104, 103, 103,
    102, 102, 101, 101, 100, 100, 99, 99, 98, 98, 97, 97, 97, 96, 96, 95, 95, 94, 94, 94, 93, 93, 93, 92, 92, 91,
    91, 91, 90, 89, 89, 88, 87, 87, 86, 86, 85, 84, 84, 83, 83, 82, 82, 81, 81, 80, 80, 79, 79, 78, 78, 77, 77, 77,
    76, 76, 75, 75, 74, 74, 74, 73, 73, 73, 72, 72, 72, 71, 71, 70, 70, 70, 70, 69, 69, 69, 68, 68, 68, 67, 67, 67,
    67, 66, 66, 66, 65, 65, 65, 65, 64, 64);

// Rule inverse-square-root: 1/sqrt(|x|) in the transform unit.
uint nv2a_inverse_square_root(uint x) {
    uint m = (x & 0x7fffffu) | 0x800000u;
    int e = int((x >> 23) & 255u) - 127;
    int odd = e & 1;
    uvec2 seed = uvec2(uint(nv2a_root_seeds[int((m >> 17) & 63u) + 64 * odd]), 0u);
    uvec2 square = nv2a_u64_left(uvec2(m, 0u), odd);
    uvec2 better = nv2a_u64_right(nv2a_u64_multiply(nv2a_u64_subtract(nv2a_u64_left(uvec2(0x3u, 0x0u), 37),
        nv2a_u64_multiply(nv2a_u64_multiply(seed, seed), square)), seed), 32);
    uvec2 best = nv2a_u64_right(nv2a_u64_multiply(nv2a_u64_subtract(nv2a_u64_left(uvec2(0x3u, 0x0u), 49),
        nv2a_u64_multiply(nv2a_u64_multiply(better, better), square)), better), 39);
    return nv2a_with_limits(nv2a_packed(0u, best, -24 - (e >> 1), 24), x & 0x7fffffffu);
}

// ------------------------------------------------------------------------------------- products and sums

uint nv2a_program_product(uint a, uint b) {
    if (nv2a_is_zero(a) != 0 || nv2a_is_zero(b) != 0) {
        return 0u;
    }
    if (nv2a_is_nan(a) != 0 || nv2a_is_nan(b) != 0) {
        return 0x7fc00000u;
    }
    if (nv2a_is_infinite(a) != 0 || nv2a_is_infinite(b) != 0) {
        return ((a ^ b) & 0x80000000u) | 0x7f800000u;
    }
    return nv2a_finite_product(a, b, 24);
}

// The sum of four terms; infinities keep their signs, and two of both signs are NaN.
uint nv2a_program_sum(uvec4 x) {
    uint found = 0u;
    for (int k = 0; k < 4; k++) {
        if (nv2a_is_nan(x[k]) != 0) {
            return 0x7fc00000u;
        }
        if (nv2a_is_infinite(x[k]) != 0) {
            if (found != 0u && found != x[k]) {
                return 0x7fc00000u;
            }
            found = x[k];
        }
    }
    return found != 0u ? found : nv2a_finite_sum(x, 24, 5);
}

uint nv2a_program_add(uint a, uint b) {
    uvec4 terms = uvec4(a, b, 0u, 0u);
    return nv2a_program_sum(terms);
}

// Rules vertex-...: the instructions; the result is four singles, from operands of four, or of one (x).
void nv2a_vertex_mul(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_program_product(nv2a_flushed(a[k]), nv2a_flushed(b[k]));
    }
}

void nv2a_vertex_add(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_program_add(nv2a_flushed(a[k]), nv2a_flushed(b[k]));
    }
}

void nv2a_vertex_mad(uvec4 a, uvec4 b, uvec4 c, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        uint product = nv2a_program_product(nv2a_flushed(a[k]), nv2a_flushed(b[k]));
        result[k] = nv2a_program_add(product, nv2a_flushed(c[k]));
    }
}

// The sum of four products, the last of a's w times that of b.
uint nv2a_program_dot(uvec4 a, uvec4 b, uint w) {
    uvec4 terms;
    for (int k = 0; k < 3; k++) {
        terms[k] = nv2a_program_product(nv2a_flushed(a[k]), nv2a_flushed(b[k]));
    }
    terms[3] = nv2a_program_product(nv2a_flushed(w), nv2a_flushed(b[3]));
    return nv2a_program_sum(terms);
}

void nv2a_everywhere(uint value, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = value;
    }
}

void nv2a_vertex_dp3(uvec4 a, uvec4 b, out uvec4 result) {
    nv2a_everywhere(nv2a_program_dot(a, b, 0u), result);
}

void nv2a_vertex_dp4(uvec4 a, uvec4 b, out uvec4 result) {
    nv2a_everywhere(nv2a_program_dot(a, b, a[3]), result);
}

void nv2a_vertex_dph(uvec4 a, uvec4 b, out uvec4 result) {
    nv2a_everywhere(nv2a_program_dot(a, b, 0x3f800000u), result);
}

void nv2a_vertex_dst(uvec4 a, uvec4 b, out uvec4 result) {
    result[0] = 0x3f800000u;
    result[1] = nv2a_program_product(nv2a_flushed(a[1]), nv2a_flushed(b[1]));
    result[2] = nv2a_flushed(a[2]);
    result[3] = nv2a_flushed(b[3]);
}

// Whether a comes before b, and -0 before 0.
int nv2a_before(uint a, uint b) {
    int x = int(nv2a_flushed(a) & 0x7fffffffu);
    int y = int(nv2a_flushed(b) & 0x7fffffffu);
    if ((a & 0x80000000u) != 0u) {
        x = -x - 1;
    }
    if ((b & 0x80000000u) != 0u) {
        y = -y - 1;
    }
    return int(x < y);
}

void nv2a_vertex_min(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_flushed(nv2a_before(a[k], b[k]) != 0 ? a[k] : b[k]);
    }
}

void nv2a_vertex_max(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_flushed(nv2a_before(a[k], b[k]) != 0 ? b[k] : a[k]);
    }
}

void nv2a_vertex_slt(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_before(a[k], b[k]) != 0 ? 0x3f800000u : 0u;
    }
}

void nv2a_vertex_sge(uvec4 a, uvec4 b, out uvec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_before(a[k], b[k]) != 0 ? 0u : 0x3f800000u;
    }
}

// 1/x with the sign of x, of zeros and infinities too.
uint nv2a_signed_reciprocal(uint x) {
    uint found = nv2a_reciprocal(x);
    return nv2a_is_nan(x) != 0 ? found : (found & 0x7fffffffu) | (x & 0x80000000u);
}

void nv2a_vertex_rcp(uint a, out uvec4 result) {
    nv2a_everywhere(nv2a_signed_reciprocal(nv2a_flushed(a)), result);
}

void nv2a_vertex_rcc(uint a, out uvec4 result) {
    uint found = nv2a_signed_reciprocal(nv2a_flushed(a));
    uint size = found & 0x7fffffffu;
    if (!(nv2a_is_nan(found) != 0)) {
        if (size < 0x1f800000u) {
            size = 0x1f800000u;
        }
        if (size > 0x5f800000u) {
            size = 0x5f800000u;
        }
        found = (found & 0x80000000u) | size;
    }
    nv2a_everywhere(found, result);
}

void nv2a_vertex_rsq(uint a, out uvec4 result) {
    nv2a_everywhere(nv2a_inverse_square_root(nv2a_flushed(a)), result);
}

// Where the 32 pieces of 2^x begin, in steps of the table, and of log2 x.
const int nv2a_power_starts[33] = int[33](0, 359, 725, 1100, 1483, 1874, 2274, 2683, 3100, 3527, 3963, 4408, 4863,
    5329, 5804, 6290, 6787, 7294, 7812, 8342, 8884, 9437, 10002, 10580, 11171, 11774, 12391, 13020, 13665, 14322,
    14995, 15684, 16383);

const int nv2a_logarithm_starts[33] = int[33](0, 11702, 22973, 33939, 44589, 54950, 65056, 74856, 84430, 93767,
    102879, 111777, 120470, 128969, 137279, 145412, 153374, 161170, 168811, 176299, 183642, 190844, 197914, 204853,
    211667, 218359, 224937, 231401, 237757, 244008, 250155, 256213, 262143);

// x in steps of 1/8192, not above x; 0 below 2^-23 in magnitude.
int nv2a_power_steps(uint x) {
    int e = int((x >> 23) & 255u) - 127;
    int negative = int((x & 0x80000000u) != 0u);
    if (nv2a_is_nan(x) != 0) {
        return 4194304;
    }
    if (e < -23) {
        return 0;
    }
    if (e >= 9) {
        return negative != 0 ? -4194304 : 4194304;
    }
    int down = nv2a_least(10 - e, 25);
    int m = int((x & 0x7fffffu) | 0x800000u);
    return negative != 0 ? -((m + (1 << down) - 1) >> down) : m >> down;
}

// 2^(steps / 8192).
uint nv2a_power_of_steps(int steps) {
    int whole = steps >> 13;
    int piece = (steps >> 8) & 31;
    int rest = steps & 255;
    int slope = nv2a_power_starts[piece + 1] - nv2a_power_starts[piece];
    int fraction = nv2a_power_starts[piece] * 256 + slope * rest;
    if (whole <= -127) {
        return 0u;
    }
    if (whole >= 128) {
        return 0x7f800000u;
    }
    return (uint(whole + 127) << 23) | uint(2 * fraction);
}

// x - floor(x), of negative x in steps of 2^-23.
uint nv2a_power_fraction(uint x) {
    int e = int((x >> 23) & 255u) - 127;
    uint m = (x & 0x7fffffu) | 0x800000u;
    if (nv2a_is_nan(x) != 0) {
        return 0x7fc00000u;
    }
    if (nv2a_is_zero(x) != 0 || e >= 23) {
        return 0u;
    }
    if ((x & 0x80000000u) == 0u) {
        if (e < 0) {
            return x;
        }
        return nv2a_packed(0u, uvec2(m & ((1u << (23 - e)) - 1u), 0u), e - 23, 24);
    }
    if (e < -23) {
        return 0x3f800000u;
    }
    uint steps = e < 0 ? (m + (1u << -e) - 1u) >> -e : m << e;
    return nv2a_packed(0u, uvec2((0u - steps) & 0x7fffffu, 0u), -23, 24);
}

void nv2a_vertex_exp(uint a, out uvec4 result) {
    uint x = nv2a_flushed(a);
    int steps = nv2a_power_steps(x);
    result[0] = nv2a_power_of_steps((steps >> 13) * 8192);
    result[1] = nv2a_power_fraction(x);
    result[2] = nv2a_is_nan(x) != 0 ? 0x7fc00000u : nv2a_power_of_steps(steps);
    result[3] = 0x3f800000u;
}

// log2 of a positive finite number, in steps of 2^-26.
uvec2 nv2a_logarithm_steps(uint x) {
    int fraction = int(x & 0x7fffffu);
    int piece = fraction >> 18;
    int rest = (fraction >> 10) & 255;
    int slope = nv2a_logarithm_starts[piece + 1] - nv2a_logarithm_starts[piece];
    int climbed = nv2a_logarithm_starts[piece] * 256 + slope * rest;
    return nv2a_u64_add(nv2a_u64_multiply(nv2a_i64_of_int(int((x >> 23) & 255u) - 127), uvec2(67108864u, 0u)),
        nv2a_i64_of_int(climbed));
}

void nv2a_vertex_log(uint a, out uvec4 result) {
    uint x = nv2a_flushed(a) & 0x7fffffffu;
    result[3] = 0x3f800000u;
    if (!(nv2a_is_finite(x) != 0)) {
        result[0] = nv2a_is_nan(x) != 0 ? 0x7fc00000u : x;
        result[1] = nv2a_is_nan(x) != 0 ? 0x7fc00000u : 0x3f800000u;
        result[2] = result[0];
    } else if (nv2a_is_zero(x) != 0) {
        result[0] = 0xff800000u;
        result[1] = 0x3f800000u;
        result[2] = 0xff800000u;
    } else {
        int e = int(x >> 23) - 127;
        uvec2 steps = nv2a_logarithm_steps(x);
        int negative = int(nv2a_i64_less(steps, uvec2(0u, 0u)));
        uvec2 size = negative != 0 ? nv2a_u64_subtract(uvec2(0x0u, 0x0u), steps) : steps;
        result[0] = nv2a_packed(e < 0 ? 0x80000000u : 0u, uvec2(uint(e < 0 ? -e : e), 0u), 0, 24);
        result[1] = (x & 0x7fffffu) | 0x3f800000u;
        result[2] = nv2a_packed(negative != 0 ? 0x80000000u : 0u, size, -26, 24);
    }
}

// 2^(power log2 base), as LIT's z where x is positive.
uint nv2a_lit_power(uint base, uint power) {
    if (nv2a_is_zero(power) != 0) {
        return 0x3f800000u;
    }
    if (nv2a_is_nan(base) != 0 || nv2a_is_nan(power) != 0) {
        return 0x7fc00000u;
    }
    int negative = int((power & 0x80000000u) != 0u);
    if (nv2a_is_infinite(base) != 0) {
        return negative != 0 ? 0u : 0x7f800000u;
    }
    if (nv2a_is_zero(base) != 0 || (base & 0x80000000u) != 0u) {
        return negative != 0 ? 0x7f800000u : 0u;
    }
    uvec2 by = nv2a_i64_of_int(nv2a_clamp(nv2a_power_steps(power), -1048576, 1048575));
    return nv2a_power_of_steps(int(nv2a_i64_right(nv2a_u64_multiply(nv2a_logarithm_steps(base), by), 26).x));
}

void nv2a_vertex_lit(uvec4 a, out uvec4 result) {
    uint x = nv2a_flushed(a[0]);
    result[0] = 0x3f800000u;
    result[1] = (x & 0x80000000u) != 0u ? 0u : x;
    result[2] = result[1] != 0u ? nv2a_lit_power(nv2a_flushed(a[1]), nv2a_flushed(a[3])) : 0u;
    result[3] = 0x3f800000u;
}

// Rule vertex-arl: the largest whole number that is not above a, within -2^30 and 2^30.
int nv2a_vertex_arl(uint a) {
    return nv2a_floor_of_f64(nv2a_f64_of_single(nv2a_flushed(a)));
}
