"""The Combiner suite's captures, drawn in GLSL by the shaders that docs/examples/combiner_shader.py makes."""

import importlib.util
import re
import subprocess
import sys

import numpy as np
import pytest

from bench.peers.mesa import PeerError
from fixedpipe.effects.conformance.captures import find_captures
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
from fixedpipe.effects.conformance.redraw import TEXT, known_suites
from fixedpipe.effects.emulators.code import code_files
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.notations.nv2a_registers import format_registers
from fixedpipe.pipeline.profiles import NV2A
from fixedpipe.pipeline.vertices.stage import process
from tests.emulators.calls import Call, Value, constants
from tests.emulators.mesa import Shaders, library, needed
from tests.layers import ROOT

EXAMPLE = ROOT / "docs" / "examples" / "combiner_shader.py"
SUITE = "Combiner"
CASES = (
    *("AlphaFromBlue", "ColorAlphaIndependence", "CombinerOps", "Flags", "Independence", "Mux"),
    *("SpecialInputs", "UnboundTexSampler"),
)
# A pixel beside a triangle of one colour: what the framebuffer holds after it, and whether it is drawn.
DRAWN = Call(
    "drawn",
    {
        "place": Value("int", 2),
        "x": Value("int", 3),
        "y": Value("int", 3),
        "primary": Value("int", 4),
        "stored": Value("int", 4),
    },
    Value("int", 5),
)
_FUNCTION = """
void drawn(ivec2 place, ivec3 x, ivec3 y, ivec4 primary, ivec4 stored, out int result[5]) {{
    ivec4 texels[4], kept;
    for (int k = 0; k < 4; k++) texels[k] = ivec4(0, 0, 0, 255);
    ivec4 found = combined(texels, primary, ivec4(0), ivec4(0));
    nv2a_blend({equation}, {source}, {destination}, found, stored, ivec4(0), kept);
    for (int k = 0; k < 4; k++) result[k] = kept[k];
    result[4] = nv2a_coverage(x, y, place.x, place.y);
}}
"""


@pytest.fixture(scope="module")
def shaders():
    try:
        mesa = Shaders()
    except PeerError as reason:
        pytest.skip(str(reason))
    yield mesa
    mesa.close()


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("combiner_shader", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _shader(example, state):
    """GLSL of ``drawn`` with the state's combiners and blending."""
    main = example.main_function(example.words_of(format_registers(state.register_combiners)))
    blending = state.blending
    function = _FUNCTION.format(
        equation=constants()[f"NV2A_EQUATION_{blending.equation.name}"],
        source=constants()[f"NV2A_FACTOR_{blending.source.name}"],
        destination=constants()[f"NV2A_FACTOR_{blending.destination.name}"],
    )
    called = set(re.findall(r"\b(nv2a_\w+)\(", main + function))
    return "\n".join([needed(sorted(called), library()), main, function])


def _pixels_of(x, y):
    """The pixels of a triangle's box, int [n, 2]."""
    columns = np.arange(max(0, x.min() >> 4), min(WIDTH, (x.max() >> 4) + 1))
    rows = np.arange(max(0, y.min() >> 4), min(HEIGHT, (y.max() >> 4) + 1))
    return np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)


def _draw(shaders, example, draw, image):
    """Draw a mesh of flat colours on the image, uint8 [HEIGHT, WIDTH, 4]."""
    primitives = process(draw.mesh, draw.state, NV2A, WIDTH, HEIGHT)
    rows, places = [], []
    for triangle in primitives.triangles[:, :3]:
        x, y = primitives.x[triangle], primitives.y[triangle]
        colors = primitives.colors[triangle, 0, :4]
        assert (colors == colors[0]).all(), "the suite's quads have one colour"
        at = _pixels_of(x, y)
        fixed = np.tile(np.concatenate([x, y, colors[0]]), (len(at), 1))
        rows.append(np.concatenate([at, fixed, image[at[:, 1], at[:, 0]]], axis=1))
        places.append(at)
    given, places = (np.concatenate(parts) for parts in (rows, places))
    found = shaders.run(DRAWN, given.astype(np.uint32), "330 core", _shader(example, draw.state))
    inside = found[:, 4] == 1
    image[places[inside, 1], places[inside, 0]] = found[inside, :4]


def _picture(shaders, example, commands):
    """A frame: what is drawn with textures alone by the machine, the rest in GLSL."""
    commands = list(commands)
    textured = [isinstance(c, Draw) and bool(c.state.texture_units) for c in commands]
    first = next(k for k, c in enumerate(commands) if isinstance(c, Draw) and not textured[k])
    image = execute(commands[:first], NV2A, WIDTH, HEIGHT).image().copy()
    for command in commands[first:]:
        assert isinstance(command, Draw) and not command.state.texture_units
        _draw(shaders, example, command, image)
    return image


@pytest.mark.needs_shared
@pytest.mark.parametrize("name", CASES)
def test_a_capture_of_the_combiner_suite_is_drawn_exactly_in_glsl(name, captures, shaders, example):
    capture = next(c for c in find_captures(captures, (SUITE,), name) if c.name == name)
    case, theirs = known_suites()[SUITE].case(name, None), capture.read()
    ours = _picture(shaders, example, case.commands)
    compared = case.compared() & (theirs != TEXT).any(-1)
    assert (ours == theirs).all(-1)[compared].all()
    boxes = (ours != execute([case.commands[0]], NV2A, WIDTH, HEIGHT).image()).any(-1)
    assert (boxes & compared).sum() > 1000, "something is drawn"


def test_the_example_writes_a_whole_shader(tmp_path):
    for file, data in code_files("glsl", "test").items():
        (tmp_path / file).write_bytes(data)
    case = known_suites()[SUITE].case("Mux", None)
    draw = next(c for c in case.commands if isinstance(c, Draw))
    (tmp_path / "words.txt").write_text(format_registers(draw.state.register_combiners))
    command = [sys.executable, EXAMPLE, tmp_path, tmp_path / "words.txt"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.startswith("#version 330 core")
    assert done.stdout.count("nv2a_general_combiner(file, ") == 2
