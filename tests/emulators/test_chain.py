"""The whole chain of combiners, of blending and of filters, by the chip's registers, beside frames that we
execute.
"""

import importlib.util
import re

import numpy as np
import pytest

from bench.peers.mesa import PeerError
from fixedpipe.pipeline.golden.vectors import POINTS, stage_case
from fixedpipe.pipeline.profiles import NV2A
from tests.emulators.c99 import Library, compiler
from tests.emulators.calls import Call, Value, call_of, constants
from tests.emulators.mesa import VERSIONS, Shaders, library, needed
from tests.layers import ROOT

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler here")
EXAMPLE = ROOT / "docs" / "examples" / "combiner_shader.py"
CASES = 40
_STAGES = 8
# The words that a chain of combiners reads, in the order of nv2a_test_chain's.
_EACH = tuple(
    (method, k)
    for method in ("COLOR_ICW", "COLOR_OCW", "ALPHA_ICW", "ALPHA_OCW", "FACTOR0", "FACTOR1")
    for k in range(_STAGES)
)
_CHAIN = """
static void nv2a_test_chain(const uint32_t words[53], const int colors[24], int result[4]) {
    int file[16][4];
    for (int row = 0; row < 16; row++) nv2a_rgba(0, 0, 0, 0, file[row]);
    for (int k = 0; k < 16; k++) file[8 + k / 4][k % 4] = colors[k];
    for (int k = 0; k < 8; k++) file[4 + k / 4][k % 4] = colors[16 + k];
    nv2a_first_registers(file);
    for (uint32_t k = 0; k < (words[0] & 255u); k++) {
        nv2a_constant(words[33 + ((words[0] >> 12 & 1u) != 0u ? k : 0u)], file[1]);
        nv2a_constant(words[41 + ((words[0] >> 16 & 1u) != 0u ? k : 0u)], file[2]);
        int mux_select = (int)(words[0] >> 8 & 1u);
        nv2a_general_combiner(file, words[1 + k], words[9 + k], words[17 + k], words[25 + k], mux_select);
    }
    nv2a_constant(words[49], file[1]);
    nv2a_constant(words[50], file[2]);
    nv2a_final_combiner(file, words[51], words[52], result);
}
"""
CHAIN = Call("nv2a_test_chain", {"words": Value("single", 53), "colors": Value("int", 24)}, Value("int", 4))
BLEND = Call(
    "nv2a_blend",
    {
        **{name: Value("int") for name in ("equation", "source", "destination")},
        **{name: Value("int", 4) for name in ("s", "d", "constant")},
    },
    Value("int", 4),
)


@pytest.fixture(scope="module")
def c99(tmp_path_factory):
    calls = [CHAIN, BLEND, *map(call_of, ("nearest-texel", "linear-texels", "bilinear"))]
    return Library(calls, tmp_path_factory.mktemp("chain"), before=_CHAIN)


def _words(registers):
    found = {}
    for name, word in registers.items():
        method, number = re.fullmatch(r"NV097_SET_(\w+?)(?:\[(\d+)\])?", name).groups()
        found[method, int(number or 0)] = int(word, 16)
    rows = [found.get((f"COMBINER_{method}", k), 0) for method, k in _EACH]
    last = [found.get(("SPECULAR_FOG_FACTOR", k), 0) for k in (0, 1)]
    last += [found[f"COMBINER_SPECULAR_FOG_CW{k}", 0] for k in (0, 1)]
    return [found["COMBINER_CONTROL", 0], *rows, *last]


def _colors(inputs, k):
    names = ("tex0", "tex1", "tex2", "tex3", "col0", "col1")
    return [component for name in names for component in inputs[name][k]]


def test_combiners_are_what_frames_show(c99):
    for seed in range(CASES):
        case = stage_case("combiners", NV2A, seed)
        words = _words(case["registers"])
        given = np.array([words + _colors(case["inputs"], k) for k in range(POINTS)], np.uint32)
        assert c99.run(CHAIN, given).tolist() == case["expected"], seed


def test_the_example_s_shaders_are_what_frames_show():
    try:
        shaders = Shaders()
    except PeerError as reason:
        pytest.skip(str(reason))
    spec = importlib.util.spec_from_file_location("combiner_shader", EXAMPLE)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    call = Call("shown", {"colors": Value("int", 24)}, Value("int", 4))
    shown = (
        "void shown(int colors[24], out ivec4 result) {\n    ivec4 texels[4], colour[2];\n"
        "    for (int k = 0; k < 16; k++) texels[k / 4][k % 4] = colors[k];\n"
        "    for (int k = 0; k < 8; k++) colour[k / 4][k % 4] = colors[16 + k];\n"
        "    result = combined(texels, colour[0], colour[1], ivec4(0));\n}"
    )
    for seed in range(3):
        case = stage_case("combiners", NV2A, seed)
        text = "".join(f"{name} = {word}\n" for name, word in case["registers"].items())
        main = example.main_function(example.words_of(text))
        source = "\n".join([needed(sorted(set(re.findall(r"\b(nv2a_\w+)\(", main))), library()), main, shown])
        given = np.array([_colors(case["inputs"], k) for k in range(POINTS)], np.uint32)
        for version in VERSIONS:
            assert shaders.run(call, given, version, source).tolist() == case["expected"], seed
    shaders.close()


def test_blending_is_what_frames_show(c99):
    for seed in range(2 * CASES):
        case = stage_case("blending", NV2A, seed)
        chosen = [
            constants()[f"NV2A_EQUATION_{case['equation']}"],
            constants()[f"NV2A_FACTOR_{case['source']}"],
            constants()[f"NV2A_FACTOR_{case['destination']}"],
        ]
        pairs = zip(case["inputs"]["fragment"], case["inputs"]["stored"], strict=True)
        given = np.array([[*chosen, *s, *d, *case["constant"]] for s, d in pairs], np.uint32)
        assert c99.run(BLEND, given).tolist() == case["expected"], seed


def _doubles(values):
    return np.array(values, np.float64).view(np.uint32).reshape(len(values), 2)


def _along(c99, case, axis, size):
    """Two texels of each point along an axis and the second's weight; of a nearest filter one of weight 0."""
    t = [size * st[axis] for st in case["inputs"]["st"]]
    wrap = constants()[f"NV2A_WRAP_{case['wrap'][axis]}"]
    rest = np.tile(np.array([size, wrap], np.uint32), (len(t), 1))
    given = np.concatenate([_doubles(t), rest], axis=1)
    if case["filter"] == "LINEAR":
        return c99.run(call_of("linear-texels"), given).astype(np.int64)
    found = c99.run(call_of("nearest-texel"), given).astype(np.int64)
    return np.concatenate([found, found, np.zeros_like(found)], axis=1)


def test_filters_are_what_frames_show(c99):
    for seed in range(CASES):
        case = stage_case("sampling", NV2A, seed)
        s, t = _along(c99, case, 0, case["width"]), _along(c99, case, 1, case["height"])
        texels = np.array(case["texels"])[::-1]
        taps = [texels[t[:, row], s[:, column]] for row in (0, 1) for column in (0, 1)]
        columns = [
            c99.run(call_of("bilinear"), np.stack([*(tap[:, k] for tap in taps), s[:, 2], t[:, 2]], axis=1))[
                :, 0
            ]
            for k in range(4)
        ]
        assert np.stack(columns, axis=1).tolist() == case["expected"], seed
