"""Frames as the NV2A's words: what is written and read draws the same, and no file ends in a traceback."""

import random
import shutil
import struct
import subprocess

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Inputs
from fixedpipe.effects.conformance.redraw import known_suites
from fixedpipe.effects.nv2a_frames import methods as M
from fixedpipe.effects.nv2a_frames.methods import Method
from fixedpipe.effects.nv2a_frames.reading import read_frame
from fixedpipe.effects.nv2a_frames.writing import Unwritable, frame_bytes
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.commands import Clear, Draw, HostStep, Mesh
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.state import PassState
from tests.layers import ROOT

HEADER = ROOT / "docs" / "examples" / "nv2a_frame.h"
# A case of each of these suites that needs no file of theirs.
CASES = {
    "Alpha_func": "AlphaFuncGreaterThan_Enabled",
    "Attrib_carryover": "L-w0.1_0.0_1.0_1.0-da",
    "Attrib_float": "Colors",
    "Bump_map": "BumpMap_X8R8G8B8_L",
    "Clear": "C01000000_Depth_y",
    "Color_mask_blend": "C00010101_O32774_S772_D0",
    "Combiner": "UnboundTexSampler",
    "Degenerate_begin_end": "BeginWithoutEnd",
    "Depth_buffer": "DepthFmt_z16_Cn_FZy_M00ffff",
    "Front_face": "FrontFace_LM_0x63_CF_FaB",
    "High_vertex_count": "HighVtxCount-inlineelements",
    "Inline_array_size_mismatch": "ExtraElements",
    "Null_surface": "XemuBug893",
    "Pixel_shader": "StageDependentGreenBlue",
    "Point_size": "PointSmoothOff_04_FF",
    "Stencil": "Stencil_REPLACE_ST_DT_ZB",
    "Stencil_func": "Greater",
    "Texture_border_color": "TextureBorderColor",
    "Texture_cubemap": "Cubemap",
    "Texture_CPU_Update": "RGBA",
    "Texture_format": "TexFmt_B8G8R8A8_L",
    "Texture_LOD_Bias": "LODBias",
    "Texture_palette": "XemuHighPaletteBug",
    "Texture_signed_component_tests": "A8R8G8B8_0x0009",
    "TextureWrapMode": "CylinderWrapping",
}


def case_of(suite):
    """The Case of CASES, without textures of other places."""
    return known_suites()[suite].case(CASES[suite], Inputs(None))


def test_there_are_twenty_suites():
    assert len(CASES) >= 20


@pytest.mark.parametrize("suite", CASES)
def test_a_case_that_is_written_and_read_draws_the_same_pixels(suite):
    case = case_of(suite)
    frame = read_frame(frame_bytes(case.commands, WIDTH, HEIGHT, case.depth_bits), suite)
    assert (frame.width, frame.height, frame.depth_bits) == (WIDTH, HEIGHT, case.depth_bits)
    assert sum(isinstance(c, Draw) for c in frame.commands) >= sum(isinstance(c, Draw) for c in case.commands)
    ours, theirs = (
        execute(commands, NV2A, WIDTH, HEIGHT, depth_bits=case.depth_bits).framebuffer
        for commands in (case.commands, frame.commands)
    )
    np.testing.assert_array_equal(ours.image(), theirs.image())
    np.testing.assert_array_equal(ours.depth, theirs.depth)
    np.testing.assert_array_equal(ours.stencil, theirs.stencil)


def test_a_wrong_word_draws_other_pixels():
    case = case_of("Alpha_func")
    data = frame_bytes(case.commands, WIDTH, HEIGHT, case.depth_bits)
    at = data.index(struct.pack("<3I", M.WORDS, Method.ALPHA_FUNC, 1)) + 12
    assert data[at : at + 4] == struct.pack("<I", 0x204)  # GREATER
    wrong = data[:at] + struct.pack("<I", 0x201) + data[at + 4 :]
    same, other = (read_frame(each, "it").image() for each in (data, wrong))
    assert (same != other).any()


# ------------------------------------------------------------------------------------------------ C


def calls_of(data):
    """C that writes a file's records by nv2a_frame.h."""
    width, height, depth = struct.unpack_from("<3I", data, 8)
    lines, at = [f"nv2a_frame_begin(f, {width}u, {height}u, {depth}u);"], 20
    while at < len(data):
        kind, place, count = struct.unpack_from("<3I", data, at)
        at += 12
        if kind == M.MEMORY:
            values = ",".join(map(str, data[at : at + count]))
            call = f"unsigned char b[] = {{{values}}}; nv2a_frame_memory(f, {place}u, b, {count}u);"
            at += count + -count % 4
        else:
            size = count * (4 * bin(place).count("1") if kind == M.VERTICES else 1)
            values = ",".join(f"{w}u" for w in struct.unpack_from(f"<{size}I", data, at))
            call = f"uint32_t w[] = {{{values}}}; "
            if kind == M.VERTICES:
                call += (
                    f"float v[{size}]; memcpy(v, w, sizeof v); nv2a_frame_vertices(f, {place}u, v, {count}u);"
                )
            elif count == 1:
                call += f"nv2a_frame_word(f, {place}u, w[0]);"
            else:
                call += f"nv2a_frame_words(f, {place}u, w, {count}u);"
            at += 4 * size
        lines.append(f"{{ {call} }}")
    return lines


@pytest.mark.parametrize("suite", ["Alpha_func", "Stencil_func", "Texture_border_color"])
def test_the_header_writes_the_same_bytes(tmp_path, suite):
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler")
    case = case_of(suite)
    data = frame_bytes(case.commands, WIDTH, HEIGHT, case.depth_bits)
    body = "\n".join(calls_of(data))
    source, program, out = (tmp_path / name for name in ("f.c", "f", "f.nv2a"))
    source.write_text(
        f'#include "nv2a_frame.h"\nint main(int n, char **a) {{ (void)n; FILE *f = fopen(a[1], "wb");\n'
        f"{body}\nreturn fclose(f); }}\n"
    )
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", f"-I{HEADER.parent}"]
    subprocess.run(["cc", *options, "-o", program, source], check=True)
    subprocess.run([program, out], check=True)
    assert out.read_bytes() == data


# ----------------------------------------------------------------------------------------- what is no frame


def test_a_damaged_file_is_read_or_ends_in_a_sentence():
    case, chance = case_of("Stencil_func"), random.Random(3)
    data = frame_bytes(case.commands, WIDTH, HEIGHT, case.depth_bits)
    refused = 0
    for _ in range(500):
        damaged = bytearray(data)
        for _ in range(1 + chance.randrange(3)):
            damaged[chance.randrange(8, len(data))] = chance.randrange(256)
        if chance.random() < 0.3:
            damaged = damaged[: chance.randrange(len(damaged))]
        try:
            read_frame(bytes(damaged), "it")
        except Refusal as refusal:
            refused += 1
            assert str(refusal).endswith(".") and "\n" not in str(refusal)
    assert 50 < refused < 500


def record(kind, place, *words):
    """A record of words."""
    return struct.pack(f"<3I{len(words)}I", kind, place, len(words), *words)


HEAD = M.MAGIC + struct.pack("<3I", 8, 8, 2)
BAD = {
    b"": "does not begin with NV2AFRM1",
    M.MAGIC: "ends within a record",
    M.MAGIC + struct.pack("<3I", 0, 8, 2): "a window of 0x8",
    M.MAGIC + struct.pack("<3I", 8, 8, 9): "depth format 9",
    HEAD + record(7, 0): "a record of kind 7",
    HEAD + record(M.WORDS, 0x100, 1): "register 0x0100, which is no part of the format",
    HEAD + struct.pack("<3I", M.MEMORY, 0, 1 << 31): "bytes are missing",
    HEAD + struct.pack("<3I", M.VERTICES, 1, 1): "before SET_BEGIN_END",
    HEAD + record(M.WORDS, Method.BEGIN_END, 11): "begins primitive 11",
    HEAD + record(M.WORDS, Method.BEGIN_END, 5): "end the primitive",
    HEAD + record(M.WORDS, Method.BEGIN_END, 5) * 2: "within another",
    HEAD + record(M.WORDS, Method.CLEAR_SURFACE, 0x10): "clear all or none",
    HEAD + record(M.WORDS, Method.BEGIN_END, 5) + struct.pack("<3I", M.VERTICES, 2, 1): "give slots 0",
    HEAD
    + record(M.WORDS, Method.BEGIN_END, 5)
    + struct.pack("<3I4f", M.VERTICES, 1, 1, 0, 0, 0, 1): "set SET_COMBINER_CONTROL",
}


@pytest.mark.parametrize("data", BAD, ids=list(BAD.values()))
def test_what_is_no_frame_ends_in_a_sentence(tmp_path, data):
    path = tmp_path / "frame.nv2a"
    path.write_bytes(data)
    result = CliRunner().invoke(main, ["nv2a", str(path)])
    assert result.exit_code == 2 and BAD[data] in result.stderr, result.output
    assert result.stderr.startswith("fixedpipe: ")


def test_a_state_without_words_is_refused():
    mesh = Mesh([[-1, -1], [3, -1], [-1, 3]])
    step = HostStep(label="h", reads=(), commands=lambda pixels: ())
    for commands in ((Draw(label="d", mesh=mesh, state=PassState()),), (step,)):
        with pytest.raises(Unwritable, match="A frame of the NV2A's words has no"):
            frame_bytes(commands, 8, 8, 24)
    with pytest.raises(Unwritable, match="depth buffer of 32"):
        frame_bytes((Clear(label="c"),), 8, 8, 32)


def test_the_command_draws_a_frame_and_writes_a_script(tmp_path):
    case = case_of("Alpha_func")
    path, out, script = (tmp_path / name for name in ("frame.nv2a", "frame.png", "frame.py"))
    path.write_bytes(frame_bytes(case.commands, WIDTH, HEIGHT, case.depth_bits))
    run = CliRunner().invoke(main, ["nv2a", str(path), "--out", str(out), "--script", str(script)])
    assert run.exit_code == 0, run.output
    assert "640x480 pixels, 1 Clear, " in run.stdout
    drawn = execute(case.commands, NV2A, WIDTH, HEIGHT).image()
    np.testing.assert_array_equal(np.asarray(Image.open(out))[..., :3], drawn[..., :3])
    told = CliRunner().invoke(main, ["inspect", str(script), "--pixel", "320,240", "--brief"])
    assert told.exit_code == 0 and "on NV2A" in told.stdout, told.output
