// The tests of fragments: docs/numbers.md, N10.1 and N10.2.

// Source: NV097_SET_ALPHA_FUNC, _DEPTH_FUNC, _STENCIL_FUNC: OpenGL's numbers.
const int NV2A_COMPARE_NEVER = 0x200;
const int NV2A_COMPARE_LESS = 0x201;
const int NV2A_COMPARE_EQUAL = 0x202;
const int NV2A_COMPARE_LEQUAL = 0x203;
const int NV2A_COMPARE_GREATER = 0x204;
const int NV2A_COMPARE_NOTEQUAL = 0x205;
const int NV2A_COMPARE_GEQUAL = 0x206;
const int NV2A_COMPARE_ALWAYS = 0x207;

// Source: NV097_SET_STENCIL_OP_FAIL: OpenGL's numbers.
const int NV2A_STENCIL_ZERO = 0;
const int NV2A_STENCIL_INVERT = 0x150a;
const int NV2A_STENCIL_KEEP = 0x1e00;
const int NV2A_STENCIL_REPLACE = 0x1e01;
const int NV2A_STENCIL_INCR = 0x1e02;
const int NV2A_STENCIL_DECR = 0x1e03;
const int NV2A_STENCIL_INCR_WRAP = 0x8507;
const int NV2A_STENCIL_DECR_WRAP = 0x8508;

// Whether a passes beside b.
int nv2a_compare(int a, int function, int b) {
    int passing = function - NV2A_COMPARE_NEVER;
    return int(((passing >> (a < b ? 0 : a == b ? 1 : 2)) & 1) == 1);
}

int nv2a_alpha_test(int alpha, int function, int reference) {
    return nv2a_compare(alpha, function, reference);
}

int nv2a_stencil_operation(int operation, int stored, int reference) {
    if (operation == NV2A_STENCIL_ZERO) {
        return 0;
    }
    if (operation == NV2A_STENCIL_REPLACE) {
        return reference;
    }
    if (operation == NV2A_STENCIL_INVERT) {
        return 255 - stored;
    }
    if (operation == NV2A_STENCIL_INCR) {
        return nv2a_least(stored + 1, 255);
    }
    if (operation == NV2A_STENCIL_DECR) {
        return nv2a_most(stored - 1, 0);
    }
    if (operation == NV2A_STENCIL_INCR_WRAP) {
        return (stored + 1) & 255;
    }
    if (operation == NV2A_STENCIL_DECR_WRAP) {
        return (stored - 1) & 255;
    }
    return stored;
}
