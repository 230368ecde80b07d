// Whole numbers of 64 bits, which GLSL 3.30 and ES 3.10 lack: a uvec2, its lower 32 bits first. The signed ones are
// two's complement. &, |, ^, ~, == and != are GLSL's own.

uvec2 nv2a_u64_add(uvec2 a, uvec2 b) {
    uint low = a.x + b.x;
    return uvec2(low, a.y + b.y + (low < a.x ? 1u : 0u));
}

uvec2 nv2a_u64_subtract(uvec2 a, uvec2 b) {
    return uvec2(a.x - b.x, a.y - b.y - (a.x < b.x ? 1u : 0u));
}

// All 64 bits of a product.
uvec2 nv2a_u32_product(uint a, uint b) {
    uint al = a & 0xffffu, ah = a >> 16, bl = b & 0xffffu, bh = b >> 16;
    uint low = al * bl, first = ah * bl, second = al * bh;
    uint middle = (low >> 16) + (first & 0xffffu) + (second & 0xffffu);
    return uvec2((middle << 16) | (low & 0xffffu), ah * bh + (first >> 16) + (second >> 16) + (middle >> 16));
}

// The lower 64 bits of a product.
uvec2 nv2a_u64_multiply(uvec2 a, uvec2 b) {
    uvec2 low = nv2a_u32_product(a.x, b.x);
    return uvec2(low.x, low.y + a.x * b.y + a.y * b.x);
}

// By 0 to 63.
uvec2 nv2a_u64_left(uvec2 a, int by) {
    int n = by & 31;
    uint low = a.x << n;
    return by > 31 ? uvec2(0u, low) : uvec2(low, (a.y << n) | ((a.x >> 1) >> (31 - n)));
}

uvec2 nv2a_u64_right(uvec2 a, int by) {
    int n = by & 31;
    uint high = a.y >> n;
    return by > 31 ? uvec2(high, 0u) : uvec2((a.x >> n) | ((a.y << 1) << (31 - n)), high);
}

uvec2 nv2a_i64_right(uvec2 a, int by) {
    int n = by & 31;
    uint high = uint(int(a.y) >> n);
    return by > 31 ? uvec2(high, uint(int(a.y) >> 31)) : uvec2((a.x >> n) | ((a.y << 1) << (31 - n)), high);
}

bool nv2a_u64_less(uvec2 a, uvec2 b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

bool nv2a_i64_less(uvec2 a, uvec2 b) {
    return int(a.y) < int(b.y) || (a.y == b.y && a.x < b.x);
}

uvec2 nv2a_i64_of_int(int n) {
    return uvec2(uint(n), uint(n >> 31));
}
