// Whole numbers of 64 bits, which GLSL 3.30 and ES 3.10 lack: a uvec2, its lower 32 bits first. The signed ones are
// two's complement. &, |, ^, ~, == and != are GLSL's own.

uvec2 nv2a_u64_add(uvec2 a, uvec2 b) {
    uint low = a.x + b.x;
    return uvec2(low, a.y + b.y + (low < a.x ? 1u : 0u));
}

uvec2 nv2a_u64_subtract(uvec2 a, uvec2 b) {
    return uvec2(a.x - b.x, a.y - b.y - (a.x < b.x ? 1u : 0u));
}

// The lower 64 bits of a product.
uvec2 nv2a_u64_multiply(uvec2 a, uvec2 b) {
    uint al = a.x & 0xffffu, ah = a.x >> 16, bl = b.x & 0xffffu, bh = b.x >> 16;
    uint low = al * bl, first = ah * bl, second = al * bh;
    uint middle = (low >> 16) + (first & 0xffffu) + (second & 0xffffu);
    uint high = ah * bh + (first >> 16) + (second >> 16) + (middle >> 16);
    return uvec2((middle << 16) | (low & 0xffffu), high + a.x * b.y + a.y * b.x);
}

// By 0 to 63.
uvec2 nv2a_u64_left(uvec2 a, int by) {
    if (by == 0) return a;
    if (by >= 32) return uvec2(0u, a.x << (by - 32));
    return uvec2(a.x << by, (a.y << by) | (a.x >> (32 - by)));
}

uvec2 nv2a_u64_right(uvec2 a, int by) {
    if (by == 0) return a;
    if (by >= 32) return uvec2(a.y >> (by - 32), 0u);
    return uvec2((a.x >> by) | (a.y << (32 - by)), a.y >> by);
}

uvec2 nv2a_i64_right(uvec2 a, int by) {
    int high = int(a.y);
    if (by == 0) return a;
    if (by >= 32) return uvec2(uint(high >> (by - 32)), uint(high >> 31));
    return uvec2((a.x >> by) | (a.y << (32 - by)), uint(high >> by));
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
