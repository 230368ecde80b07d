/* Register combiners and the final combiner, in units of 1/255: docs/numbers.md, section 8. */
#ifndef NV2A_COMBINERS_H
#define NV2A_COMBINERS_H

#include "nv2a_numbers.h"

/* The order of NV097_SET_COMBINER_COLOR_ICW's three bits. */
enum {
    NV2A_MAPPING_UNSIGNED_IDENTITY = 0,
    NV2A_MAPPING_UNSIGNED_INVERT = 1,
    NV2A_MAPPING_EXPAND_NORMAL = 2,
    NV2A_MAPPING_EXPAND_NEGATE = 3,
    NV2A_MAPPING_HALF_BIAS_NORMAL = 4,
    NV2A_MAPPING_HALF_BIAS_NEGATE = 5,
    NV2A_MAPPING_SIGNED_IDENTITY = 6,
    NV2A_MAPPING_SIGNED_NEGATE = 7
};
enum { NV2A_SCALE_NONE = 0, NV2A_SCALE_BY_TWO = 1, NV2A_SCALE_BY_FOUR = 2, NV2A_SCALE_BY_ONE_HALF = 3 };
enum { NV2A_BIAS_NONE = 0, NV2A_BIAS_BY_NEGATIVE_ONE_HALF = 1 };
enum { NV2A_MUX_LSB = 0, NV2A_MUX_MSB = 1 }; /* of NV097_SET_COMBINER_CONTROL */

/* Rule rn: n / 255 to the nearest whole number, |n| below 2^29. */
static inline int nv2a_rn(int n) {
    int twice = 2 * n + 255;
    return twice < 0 ? -((509 - twice) / 510) : twice / 510;
}

/* Rules mapping-...: a register's component as a combiner reads it. */
static inline int nv2a_mapping_unsigned_identity(int x) {
    return nv2a_most(x, 0);
}

static inline int nv2a_mapping_unsigned_invert(int x) {
    return 255 - nv2a_clamp(x, 0, 255);
}

static inline int nv2a_mapping_expand_normal(int x) {
    return 2 * nv2a_most(x, 0) - 256;
}

static inline int nv2a_mapping_expand_negate(int x) {
    return nv2a_least(256 - 2 * nv2a_most(x, 0), 255);
}

static inline int nv2a_mapping_half_bias_normal(int x) {
    return nv2a_most(x, 0) - 128;
}

static inline int nv2a_mapping_half_bias_negate(int x) {
    return 128 - nv2a_most(x, 0);
}

static inline int nv2a_mapping_signed_identity(int x) {
    return x;
}

static inline int nv2a_mapping_signed_negate(int x) {
    return nv2a_clamp(-x, -256, 255);
}

/* The mapping that three bits of an input word choose. */
static inline int nv2a_mapped(int x, int mapping) {
    if (mapping == NV2A_MAPPING_UNSIGNED_IDENTITY) return nv2a_mapping_unsigned_identity(x);
    if (mapping == NV2A_MAPPING_UNSIGNED_INVERT) return nv2a_mapping_unsigned_invert(x);
    if (mapping == NV2A_MAPPING_EXPAND_NORMAL) return nv2a_mapping_expand_normal(x);
    if (mapping == NV2A_MAPPING_EXPAND_NEGATE) return nv2a_mapping_expand_negate(x);
    if (mapping == NV2A_MAPPING_HALF_BIAS_NORMAL) return nv2a_mapping_half_bias_normal(x);
    if (mapping == NV2A_MAPPING_HALF_BIAS_NEGATE) return nv2a_mapping_half_bias_negate(x);
    if (mapping == NV2A_MAPPING_SIGNED_IDENTITY) return nv2a_mapping_signed_identity(x);
    return nv2a_mapping_signed_negate(x);
}

static inline int nv2a_general_clamp(int x) {
    return nv2a_clamp(x, -256, 255);
}

static inline int nv2a_product(int a, int b) {
    return nv2a_general_clamp(nv2a_rn(a * b));
}

static inline int nv2a_sum_of_products(int a, int b, int c, int d) {
    return nv2a_general_clamp(nv2a_rn(a * b + c * d));
}

static inline int nv2a_dot_product(const int a[3], const int b[3]) {
    return nv2a_general_clamp(nv2a_rn(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]));
}

/* Rule scale-and-bias: of a rounded sum. */
static inline int nv2a_scale_and_bias(int x, int scale, int bias) {
    if (bias == NV2A_BIAS_BY_NEGATIVE_ONE_HALF) x -= 128;
    if (scale == NV2A_SCALE_BY_TWO) x = 2 * x;
    if (scale == NV2A_SCALE_BY_FOUR) x = 4 * x;
    if (scale == NV2A_SCALE_BY_ONE_HALF) x = (x + 1) >> 1;
    return nv2a_general_clamp(x);
}

/* Rule mux-takes-cd: by SPARE0's alpha. */
static inline int nv2a_mux_takes_cd(int alpha, int select) {
    int a = nv2a_clamp(alpha, 0, 255);
    return select == NV2A_MUX_MSB ? a >= 128 : (a & 1) == 1;
}

/* Rule final-mapping. */
static inline int nv2a_final_mapping(int x, int mapping) {
    return mapping == NV2A_MAPPING_UNSIGNED_INVERT ? 255 - nv2a_clamp(x, 0, 255) : nv2a_most(x, 0);
}

static inline int nv2a_final_product(int e, int f) {
    return nv2a_rn(e * f);
}

/* Rule final-lerp: of mapped inputs, of which a sum of two registers reaches 510. */
static inline int nv2a_final_lerp(int a, int b, int c, int d) {
    int weight = nv2a_least(a, 255);
    return nv2a_clamp(nv2a_rn(weight * b + (255 - weight) * c) + d, 0, 255);
}

/* --------------------------------------------------------------------------- the chain, by the chip's words */

/* A register file: rows by the four bits of an input word: 0 zero, 1 and 2 the stage's constants, 3 fog, 4 the
 * primary colour, 5 the secondary, 8 to 11 the texels, 12 SPARE0, 13 SPARE1, 14 and 15 the final combiner's sum and
 * product. Components are red, green, blue, alpha. */

/* The file before the first stage: SPARE0 holds texture 0's alpha. A unit that is off has (0, 0, 0, 255). */
static inline void nv2a_first_registers(int file[16][4]) {
    for (int k = 0; k < 4; k++) {
        file[0][k] = 0;
        file[12][k] = 0;
        file[13][k] = 0;
    }
    file[12][3] = file[8][3];
}

/* A constant's word, 0xAARRGGBB, into a row. */
static inline void nv2a_constant(uint32_t argb, int result[4]) {
    result[0] = (int)(argb >> 16 & 255u);
    result[1] = (int)(argb >> 8 & 255u);
    result[2] = (int)(argb & 255u);
    result[3] = (int)(argb >> 24);
}

/* Component k of an input that eight bits choose: a register's own, or its alpha; an alpha portion's is its blue. */
static inline int nv2a_read(int file[16][4], uint32_t bits, int k) {
    int component = (bits & 16u) != 0u ? 3 : k == 3 ? 2 : k;
    return nv2a_mapped(file[(int)(bits & 15u)][component], (int)(bits >> 5 & 7u));
}

/* A sum of products as an output: rounded, biased, scaled, clamped as bits 15 to 17 of an output word say. */
static inline int nv2a_combiner_output(int sum, uint32_t outputs) {
    int operation = (int)(outputs >> 15 & 7u), scale = NV2A_SCALE_NONE;
    if (operation == 2 || operation == 3) scale = NV2A_SCALE_BY_TWO;
    if (operation == 4) scale = NV2A_SCALE_BY_FOUR;
    if (operation == 6) scale = NV2A_SCALE_BY_ONE_HALF;
    return nv2a_scale_and_bias(nv2a_rn(sum), scale, operation == 1 || operation == 3 ? 1 : 0);
}

/* One portion's three outputs for component k, 3 in the alpha portion: AB, CD, their sum or the mux. */
static inline void nv2a_portion(
    int file[16][4], uint32_t inputs, uint32_t outputs, int k, int mux_select, int result[3]) {
    int ab = nv2a_read(file, inputs >> 24, k) * nv2a_read(file, inputs >> 16, k);
    int cd = nv2a_read(file, inputs >> 8, k) * nv2a_read(file, inputs, k);
    if (k < 3 && (outputs & 0x2000u) != 0u) {
        ab = 0;
        for (int i = 0; i < 3; i++) ab += nv2a_read(file, inputs >> 24, i) * nv2a_read(file, inputs >> 16, i);
    }
    if (k < 3 && (outputs & 0x1000u) != 0u) {
        cd = 0;
        for (int i = 0; i < 3; i++) cd += nv2a_read(file, inputs >> 8, i) * nv2a_read(file, inputs, i);
    }
    int together = ab + cd;
    if ((outputs & 0x4000u) != 0u) together = nv2a_mux_takes_cd(file[12][3], mux_select) != 0 ? cd : ab;
    result[0] = nv2a_combiner_output(ab, outputs);
    result[1] = nv2a_combiner_output(cd, outputs);
    result[2] = nv2a_combiner_output(together, outputs);
}

/* A general combiner: NV097_SET_COMBINER_COLOR_ICW, _COLOR_OCW, _ALPHA_ICW, _ALPHA_OCW; mux_select: bit 8 of
 * NV097_SET_COMBINER_CONTROL. Its constants are in rows 1 and 2. All inputs are read before any output is written. */
static inline void nv2a_general_combiner(
    int file[16][4], uint32_t color_inputs, uint32_t color_outputs, uint32_t alpha_inputs, uint32_t alpha_outputs,
    int mux_select) {
    int red[3], green[3], blue[3], alpha[3];
    nv2a_portion(file, color_inputs, color_outputs, 0, mux_select, red);
    nv2a_portion(file, color_inputs, color_outputs, 1, mux_select, green);
    nv2a_portion(file, color_inputs, color_outputs, 2, mux_select, blue);
    nv2a_portion(file, alpha_inputs, alpha_outputs & ~0x3000u, 3, mux_select, alpha);
    for (int i = 0; i < 3; i++) {
        int place = i == 0 ? 4 : i == 1 ? 0 : 8;
        int to = (int)(color_outputs >> place & 15u), alpha_to = (int)(alpha_outputs >> place & 15u);
        if (to != 0) {
            file[to][0] = red[i];
            file[to][1] = green[i];
            file[to][2] = blue[i];
        }
        if (alpha_to != 0) file[alpha_to][3] = alpha[i];
    }
    int ab = (int)(color_outputs >> 4 & 15u), cd = (int)(color_outputs & 15u);
    if ((color_outputs & 0x80000u) != 0u && ab != 0) file[ab][3] = file[ab][2];
    if ((color_outputs & 0x40000u) != 0u && cd != 0) file[cd][3] = file[cd][2];
}

/* Component k of a final combiner's input. */
static inline int nv2a_final_read(int file[16][4], uint32_t bits, int k) {
    int component = (bits & 16u) != 0u ? 3 : k;
    return nv2a_final_mapping(file[(int)(bits & 15u)][component], (int)(bits >> 5 & 7u));
}

/* The final combiner: NV097_SET_COMBINER_SPECULAR_FOG_CW0 and _CW1; NV097_SET_SPECULAR_FOG_FACTOR in rows 1 and 2.
 * The fragment's red, green, blue and alpha. */
static inline void nv2a_final_combiner(int file[16][4], uint32_t cw0, uint32_t cw1, int result[4]) {
    for (int k = 0; k < 3; k++) {
        int spare0 = nv2a_final_mapping(file[12][k], (cw1 & 0x20u) != 0u ? 1 : 0);
        int secondary = nv2a_final_mapping(file[5][k], (cw1 & 0x40u) != 0u ? 1 : 0);
        int sum = spare0 + secondary;
        file[14][k] = (cw1 & 0x80u) != 0u ? nv2a_least(sum, 255) : sum;
    }
    file[14][3] = 0;
    file[15][3] = 0;
    for (int k = 0; k < 3; k++) {
        file[15][k] = nv2a_final_product(nv2a_final_read(file, cw1 >> 24, k), nv2a_final_read(file, cw1 >> 16, k));
    }
    for (int k = 0; k < 3; k++) {
        result[k] = nv2a_final_lerp(
            nv2a_final_read(file, cw0 >> 24, k), nv2a_final_read(file, cw0 >> 16, k),
            nv2a_final_read(file, cw0 >> 8, k), nv2a_final_read(file, cw0, k));
    }
    uint32_t g = cw1 >> 8;
    result[3] = nv2a_clamp(nv2a_final_read(file, g, (g & 16u) != 0u ? 3 : 2), 0, 255);
}

#endif
