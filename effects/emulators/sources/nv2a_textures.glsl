// Where a texture is read, how its texels are filtered, and cube maps: docs/numbers.md, N6.8 to N6.10 and N7.7.

// Source: NV097_SET_TEXTURE_ADDRESS.
const int NV2A_WRAP_REPEAT = 1;
const int NV2A_WRAP_MIRRORED_REPEAT = 2;
const int NV2A_WRAP_CLAMP_TO_EDGE = 3;
const int NV2A_WRAP_CLAMP_TO_BORDER = 4;
const int NV2A_WRAP_CLAMP = 5;

// t, in texels, brought into the range of an axis of so many; what is not a number becomes its lower end.
uvec2 nv2a_wrapped(uvec2 t, int size, int wrap) {
    uvec2 n = nv2a_f64_of_int(size);
    uvec2 low = uvec2(0x0u, 0x0u);
    uvec2 high = n;
    uvec2 middle = uvec2(0x0u, 0x3fe00000u);
    if (wrap == NV2A_WRAP_MIRRORED_REPEAT) {
        high = nv2a_f64_of_int(2 * size);
    }
    if (wrap == NV2A_WRAP_CLAMP_TO_EDGE) {
        low = middle;
        high = nv2a_f64_subtract(n, middle);
    }
    if (wrap == NV2A_WRAP_CLAMP_TO_BORDER) {
        low = nv2a_f64_negated(middle);
        high = nv2a_f64_add(n, middle);
    }
    if (wrap == NV2A_WRAP_REPEAT || wrap == NV2A_WRAP_MIRRORED_REPEAT) {
        uvec2 turns = nv2a_f64_multiply(t, nv2a_f64_divide(uvec2(0x0u, 0x3ff00000u), high));
        t = nv2a_f64_subtract(t, nv2a_f64_multiply(high, nv2a_f64_floor(turns)));
    }
    if (!(nv2a_f64_less(low, t) != 0)) {
        return low;
    }
    return nv2a_f64_less(t, high) != 0 ? t : high;
}

// The texel of a whole number beside a wrapped coordinate: 0 to size - 1, or -1, the border's colour.
int nv2a_texel_index(int i, int size, int wrap, int linear) {
    int turn = wrap == NV2A_WRAP_MIRRORED_REPEAT ? 2 * size : size;
    if (wrap == NV2A_WRAP_REPEAT || wrap == NV2A_WRAP_MIRRORED_REPEAT) {
        if (i < 0) {
            i += turn;
        }
        if (i >= turn) {
            i -= turn;
        }
        return i < size ? i : turn - 1 - i;
    }
    if (wrap == NV2A_WRAP_CLAMP_TO_BORDER || (wrap == NV2A_WRAP_CLAMP && linear != 0)) {
        return i < 0 || i >= size ? -1 : i;
    }
    return nv2a_clamp(i, 0, size - 1);
}

// Rule nearest-texel: t in texels.
int nv2a_nearest_texel(uvec2 t, int size, int wrap) {
    return nv2a_texel_index(nv2a_floor_of_f64(nv2a_wrapped(t, size, wrap)), size, wrap, 0);
}

// Rule linear-texels: two texels, and the second's weight in 256ths.
void nv2a_linear_texels(uvec2 t, int size, int wrap, out ivec3 result) {
    uvec2 from = nv2a_f64_subtract(nv2a_wrapped(t, size, wrap), uvec2(0x0u, 0x3fe00000u));
    int at = nv2a_floor_of_f64(nv2a_f64_multiply(from, uvec2(0x0u, 0x40700000u)));
    result[0] = nv2a_texel_index(at >> 8, size, wrap, 1);
    result[1] = nv2a_texel_index((at >> 8) + 1, size, wrap, 1);
    result[2] = at & 255;
}

// From p to q by f of 256.
int nv2a_filter_step(int p, int q, int f) {
    return (p * (256 - f) + q * f + 128) >> 8;
}

// One component of four texels: along s by a, then along t by b.
int nv2a_bilinear(int p00, int p10, int p01, int p11, int a, int b) {
    return nv2a_filter_step(nv2a_filter_step(p00, p10, a), nv2a_filter_step(p01, p11, a), b);
}

// The same of all four components.
void nv2a_bilinear_texel(ivec4 p00, ivec4 p10, ivec4 p01, ivec4 p11, int a, int b, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_bilinear(p00[k], p10[k], p01[k], p11[k], a, b);
    }
}

// Two levels' texels, by the second's weight of 256.
void nv2a_between_levels(ivec4 level, ivec4 next, int f, out ivec4 result) {
    for (int k = 0; k < 4; k++) {
        result[k] = nv2a_filter_step(level[k], next[k], f);
    }
}

// 2^(k/128) as doubles.
const uvec2 nv2a_octave[128] = uvec2[128](uvec2(0x0u, 0x3ff00000u), uvec2(0xa9fb3335u, 0x3ff0163du),
    uvec2(0x3e778061u, 0x3ff02c9au), uvec2(0xe86e7f85u, 0x3ff04315u), uvec2(0xd3158574u, 0x3ff059b0u),
    uvec2(0x29ddf6deu, 0x3ff0706bu), uvec2(0x18759bc8u, 0x3ff08745u), uvec2(0xcac6f383u, 0x3ff09e3eu),
    uvec2(0x6cf9890fu, 0x3ff0b558u), uvec2(0x2b7247f7u, 0x3ff0cc92u), uvec2(0x32d3d1a2u, 0x3ff0e3ecu),
    uvec2(0xaffed31bu, 0x3ff0fb66u), uvec2(0xd0125b51u, 0x3ff11301u), uvec2(0xc06c31ccu, 0x3ff12abdu),
    uvec2(0xaea92de0u, 0x3ff1429au), uvec2(0xc8a58e51u, 0x3ff15a98u), uvec2(0x3c7d517bu, 0x3ff172b8u),
    uvec2(0x388c8deau, 0x3ff18af9u), uvec2(0xeb6fcb75u, 0x3ff1a35bu), uvec2(0x84045cd4u, 0x3ff1bbe0u),
    uvec2(0x3168b9aau, 0x3ff1d487u), uvec2(0x22fcd91du, 0x3ff1ed50u), uvec2(0x88628cd6u, 0x3ff2063bu),
    uvec2(0x917ddc96u, 0x3ff21f49u), uvec2(0x6e756238u, 0x3ff2387au), uvec2(0x4fb2a63fu, 0x3ff251ceu),
    uvec2(0x65e27cddu, 0x3ff26b45u), uvec2(0xe1f56381u, 0x3ff284dfu), uvec2(0xf51fdee1u, 0x3ff29e9du),
    uvec2(0xd0dad990u, 0x3ff2b87fu), uvec2(0xa6e4030bu, 0x3ff2d285u), uvec2(0xa93e2f56u, 0x3ff2ecafu),
    uvec2(0xa31b715u, 0x3ff306feu), uvec2(0xfc4cd831u, 0x3ff32170u), uvec2(0xb26416ffu, 0x3ff33c08u),
    uvec2(0x5f929ff1u, 0x3ff356c5u), uvec2(0x373aa9cbu, 0x3ff371a7u), uvec2(0x6d05d866u, 0x3ff38caeu),
    uvec2(0x34e59ff7u, 0x3ff3a7dbu), uvec2(0xc313a8e5u, 0x3ff3c32du), uvec2(0x4c123422u, 0x3ff3dea6u),
    uvec2(0x4ac801cu, 0x3ff3fa45u), uvec2(0x21f72e2au, 0x3ff4160au), uvec2(0xd950a897u, 0x3ff431f5u),
    uvec2(0x6061892du, 0x3ff44e08u), uvec2(0xed1d0057u, 0x3ff46a41u), uvec2(0xb5c13cd0u, 0x3ff486a2u),
    uvec2(0xf0d7d3deu, 0x3ff4a32au), uvec2(0xd5362a27u, 0x3ff4bfdau), uvec2(0x99fddd0du, 0x3ff4dcb2u),
    uvec2(0x769d2ca7u, 0x3ff4f9b2u), uvec2(0xa2cf6642u, 0x3ff516dau), uvec2(0x569d4f82u, 0x3ff5342bu),
    uvec2(0xca5d920fu, 0x3ff551a4u), uvec2(0x36b527dau, 0x3ff56f47u), uvec2(0xd497c7fdu, 0x3ff58d12u),
    uvec2(0xdd485429u, 0x3ff5ab07u), uvec2(0x8a5946b7u, 0x3ff5c926u), uvec2(0x15ad2148u, 0x3ff5e76fu),
    uvec2(0xb976dc09u, 0x3ff605e1u), uvec2(0xb03a5585u, 0x3ff6247eu), uvec2(0x34ccc320u, 0x3ff64346u),
    uvec2(0x82552225u, 0x3ff66238u), uvec2(0xd44ca973u, 0x3ff68155u), uvec2(0x667f3bcdu, 0x3ff6a09eu),
    uvec2(0x750bdabfu, 0x3ff6c012u), uvec2(0x3c651a2fu, 0x3ff6dfb2u), uvec2(0xf9519484u, 0x3ff6ff7du),
    uvec2(0xe8ec5f74u, 0x3ff71f75u), uvec2(0x48a58174u, 0x3ff73f9au), uvec2(0x564267c9u, 0x3ff75febu),
    uvec2(0x4fde5d3fu, 0x3ff78069u), uvec2(0x73eb0187u, 0x3ff7a114u), uvec2(0x130c132u, 0x3ff7c1edu),
    uvec2(0x36cf4e62u, 0x3ff7e2f3u), uvec2(0x543e1a12u, 0x3ff80427u), uvec2(0x994cce13u, 0x3ff82589u),
    uvec2(0x4623c7adu, 0x3ff8471au), uvec2(0x9b4492edu, 0x3ff868d9u), uvec2(0xd98a6699u, 0x3ff88ac7u),
    uvec2(0x422aa0dbu, 0x3ff8ace5u), uvec2(0x16b5448cu, 0x3ff8cf32u), uvec2(0x99157736u, 0x3ff8f1aeu),
    uvec2(0xb91ffc6u, 0x3ff9145bu), uvec2(0xb0cdc5e5u, 0x3ff93737u), uvec2(0xcbc8520fu, 0x3ff95a44u),
    uvec2(0x9fde4e50u, 0x3ff97d82u), uvec2(0x70ca07bau, 0x3ff9a0f1u), uvec2(0x82a3f090u, 0x3ff9c491u),
    uvec2(0x19e32323u, 0x3ff9e863u), uvec2(0x7b5de565u, 0x3ffa0c66u), uvec2(0xec4a2d33u, 0x3ffa309bu),
    uvec2(0xb23e255du, 0x3ffa5503u), uvec2(0x1330b358u, 0x3ffa799eu), uvec2(0x5579fdbfu, 0x3ffa9e6bu),
    uvec2(0xbfd3f37au, 0x3ffac36bu), uvec2(0x995ad3adu, 0x3ffae89fu), uvec2(0x298db666u, 0x3ffb0e07u),
    uvec2(0xb84f15fbu, 0x3ffb33a2u), uvec2(0x8de5593au, 0x3ffb5972u), uvec2(0xf2fb5e47u, 0x3ffb7f76u),
    uvec2(0x30a1064au, 0x3ffba5b0u), uvec2(0x904bc1d2u, 0x3ffbcc1eu), uvec2(0x5bd71e09u, 0x3ffbf2c2u),
    uvec2(0xdd85529cu, 0x3ffc199bu), uvec2(0x5fffd07au, 0x3ffc40abu), uvec2(0x2e57d14bu, 0x3ffc67f1u),
    uvec2(0x9406e7b5u, 0x3ffc8f6du), uvec2(0xdcef9069u, 0x3ffcb720u), uvec2(0x555dc3fau, 0x3ffcdf0bu),
    uvec2(0x4a07897cu, 0x3ffd072du), uvec2(0x80d89f2u, 0x3ffd2f87u), uvec2(0xdcfba487u, 0x3ffd5818u),
    uvec2(0x16c98398u, 0x3ffd80e3u), uvec2(0x3db3285u, 0x3ffda9e6u), uvec2(0xf301b460u, 0x3ffdd321u),
    uvec2(0x337b9b5fu, 0x3ffdfc97u), uvec2(0x14f5a129u, 0x3ffe2646u), uvec2(0xe78b3ff6u, 0x3ffe502eu),
    uvec2(0xfbc74c83u, 0x3ffe7a51u), uvec2(0xa2a490dau, 0x3ffea4afu), uvec2(0x2d8e67f1u, 0x3ffecf48u),
    uvec2(0xee615a27u, 0x3ffefa1bu), uvec2(0x376bba97u, 0x3fff252bu), uvec2(0x5b6e4540u, 0x3fff5076u),
    uvec2(0xad9cbe14u, 0x3fff7bfdu), uvec2(0x819e90d8u, 0x3fffa7c1u), uvec2(0x2b8f71f1u, 0x3fffd3c2u));

// Rule lambda: floor(128 log2(rho2)) of a positive finite double.
int nv2a_lambda(uvec2 rho2) {
    uvec2 m = nv2a_f64_significand(rho2);
    m = (nv2a_u64_left(m, 52 - nv2a_top_bit_64(m)) & uvec2(0xffffffffu, 0xfffffu)) | uvec2(0x0u, 0x3ff00000u);
    int k = 0;
    for (int by = 64; by > 0; by = by >> 1) {
        if (!nv2a_u64_less(m, nv2a_octave[k + by])) {
            k += by;
        }
    }
    return 128 * (nv2a_f64_bound(rho2) - 1) + k;
}

// Rule cube-face: +x, -x, +y, -y, +z, -z are 0 to 5.
int nv2a_cube_face(uint s, uint t, uint r) {
    uint x = s & 0x7fffffffu;
    uint y = t & 0x7fffffffu;
    uint z = r & 0x7fffffffu;
    if (x >= y && x >= z) {
        return (s & 0x80000000u) != 0u && x != 0u ? 1 : 0;
    }
    if (y >= z) {
        return (t & 0x80000000u) != 0u ? 3 : 2;
    }
    return (r & 0x80000000u) != 0u ? 5 : 4;
}

// A face's coordinate of one component, in texels of an edge of so many; lifted over double precision's noise.
uvec2 nv2a_face_coordinate(uint c, uint major, int size) {
    uvec2 lift = uvec2(0x0u, 0x3e700000u);
    if ((major & 0x7fffffffu) == 0u) {
        return lift;
    }
    uvec2 quotient = nv2a_f64_divide(nv2a_f64_of_single(c), nv2a_f64_of_single(major & 0x7fffffffu));
    uvec2 reach = nv2a_f64_multiply(nv2a_f64_of_int(size), uvec2(0x0u, 0x3fe00000u));
    return nv2a_f64_add(nv2a_f64_multiply(nv2a_f64_add(quotient, uvec2(0x0u, 0x3ff00000u)), reach), lift);
}

// s and t on the direction's face of so many texels an edge.
void nv2a_cube_coordinates(uint s, uint t, uint r, int size, out uvec2 result[2]) {
    int face = nv2a_cube_face(s, t, r);
    uint minus = 0x80000000u;
    uint sc = s;
    uint tc = t ^ minus;
    uint major = r;
    if (face == 0) {
        sc = r ^ minus;
        major = s;
    }
    if (face == 1) {
        sc = r;
        major = s;
    }
    if (face == 2) {
        tc = r;
        major = t;
    }
    if (face == 3) {
        tc = r ^ minus;
        major = t;
    }
    if (face == 5) {
        sc = s ^ minus;
    }
    result[0] = nv2a_face_coordinate(sc, major, size);
    result[1] = nv2a_face_coordinate(tc, major, size);
}

// Rule cube-texel: the same of 64 texels an edge.
void nv2a_cube_texel(uint s, uint t, uint r, out uvec2 result[2]) {
    nv2a_cube_coordinates(s, t, r, 64, result);
}
