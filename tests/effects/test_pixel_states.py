"""Small states as JSON: their pixels are a machine's, and what cannot be read ends in a sentence."""

import json
import random
from copy import deepcopy
from pathlib import Path

import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from fixedpipe.effects.cli import main
from fixedpipe.effects.pixel_states.drawing import expected_pixel
from fixedpipe.effects.pixel_states.schema import json_schema
from fixedpipe.effects.pixel_states.states import MOST_CHARACTERS, read_state
from fixedpipe.effects.refusal import Refusal
from fixedpipe.pipeline.golden.vectors import frame_case, stage_case
from fixedpipe.pipeline.inspection import history
from fixedpipe.pipeline.profiles import NV2A

DOCS = Path(__file__).resolve().parents[2] / "docs"
EXAMPLES = sorted((DOCS / "examples" / "states").glob("*.json"))
PIXEL = {"draws": [{"mesh": {"colors": [[1, 1, 1]]}}]}


def pixel_of(state, profile=NV2A):
    """What the pixel of a state, given as JSON's values, holds in the end."""
    return expected_pixel(read_state(json.dumps(state), "the state"), profile).history.final


def run(state, *options):
    """``fixedpipe pixel`` on a text or on JSON's values, from standard input."""
    text = state if isinstance(state, str) else json.dumps(state)
    return CliRunner().invoke(main, ["pixel", "-", *options], input=text)


# ---------------------------------------------------------------------------------------------- its pixels


@pytest.mark.parametrize("seed", range(8))
def test_a_program_gives_the_pixels_of_the_vectors(seed):
    case = stage_case("combiners", NV2A, seed)
    names = [name for name in case["inputs"] if name.startswith("tex")]
    for k in (0, 7):
        textures = {name: {"texels": [[case["inputs"][name][k]]]} for name in names}
        primary, secondary = ([c / 255 for c in case["inputs"][name][k]] for name in ("col0", "col1"))
        state = {
            "textures": textures,
            "draws": [
                {
                    "mesh": {"colors": [primary], "secondary_colors": [secondary]},
                    "program": [f"{word} = {value}" for word, value in case["registers"].items()],
                    "state": {
                        "texture_units": [
                            {"texture": name, "sampler": {"min_filter": "NEAREST", "mag_filter": "NEAREST"}}
                            for name in names
                        ]
                    },
                }
            ],
        }
        assert list(pixel_of(state).color) == case["expected"][k]


@pytest.mark.parametrize("seed", range(8))
def test_blending_gives_the_pixels_of_the_vectors(seed):
    case = stage_case("blending", NV2A, seed)
    blending = {name: case[name] for name in ("equation", "source", "destination")}
    blending["color"] = [f"{c}/255" for c in case["constant"]]
    for k in (0, 11):
        state = {
            "clear": {"color": [f"{c}/255" for c in case["inputs"]["stored"][k]]},
            "draws": [
                {
                    "mesh": {"colors": [[f"{c}/255" for c in case["inputs"]["fragment"][k]]]},
                    "state": {"blending": blending},
                }
            ],
        }
        assert list(pixel_of(state).color) == case["expected"][k]


@pytest.mark.parametrize("seed", range(8))
def test_a_texture_gives_the_pixels_of_the_vectors(seed):
    case = stage_case("sampling", NV2A, seed)
    sampler = {"min_filter": case["filter"], "mag_filter": case["filter"]}
    sampler |= dict(zip(("wrap_s", "wrap_t"), case["wrap"], strict=True))
    state = {
        "textures": {"t": {"texels": case["texels"][::-1]}},  # a picture's top row is first there
        "draws": [{"state": {"texture_units": [{"texture": "t", "sampler": sampler}]}}],
    }
    for k in (0, 5):
        state["draws"][0]["mesh"] = {
            "colors": [[1, 1, 1]],
            "texture_coordinates": [[case["inputs"]["st"][k]]],
        }
        assert list(pixel_of(state).color) == case["expected"][k]


def draw_of_frame(draw):
    """A draw of the vectors' frames as a draw of a small state."""
    vertices, state = draw["vertices"], {}
    if (texture := draw.get("texture")) is not None:
        filters = {name: texture["filter"] for name in ("min_filter", "mag_filter")}
        wraps = dict.fromkeys(("wrap_s", "wrap_t"), texture["wrap"])
        state["texture_units"] = [{"texture": "0", "sampler": filters | wraps}]
    if (test := draw.get("alpha_test")) is not None:
        state["alpha_test"] = test | {"reference": f"{test['reference']}/255"}
    for name in ("depth_test", "stencil_test"):
        if name in draw:
            state[name] = draw[name]
    names = ("equation", "source", "destination")
    if "blending" in draw:
        told = draw["blending"]
        state["blending"] = {n: told[n] for n in names} | {"color": [f"{c}/255" for c in told["constant"]]}
    mesh = {
        "colors": [[f"{c}/255" for c in v["color"]] for v in vertices],
        "texture_coordinates": [[v["st"] for v in vertices]],
    }
    # Their window has y upwards.
    mesh["window"] = [[v["window"][0], 64 - v["window"][1], v["window"][2], v["w"]] for v in vertices]
    return {"mesh": mesh, "state": state}


@pytest.mark.parametrize("seed", range(6))
def test_triangles_tests_and_depth_give_the_pixels_of_the_vectors(seed):
    case, framebuffer = frame_case(NV2A, seed)
    clear = case["clear"] | {"color": [f"{c}/255" for c in case["clear"]["color"]]}
    state = {
        **{"width": 64, "height": 64, "clear": clear},
        "textures": {"0": {"texels": case["texture"]["texels"][::-1]}},
        "draws": [draw_of_frame(draw) for draw in case["draws"]],
    }
    image = framebuffer.image()
    for x, y in ((20, 30), (40, 17), (33, 50)):
        found = pixel_of(state | {"pixel": [x, y]})
        assert list(found.color) == image[y, x].tolist()
        assert (found.depth, found.stencil) == (framebuffer.depth[y, x], framebuffer.stencil[y, x])


def test_a_number_is_a_decimal_a_fraction_or_the_bits_of_a_single():
    colors = [[0.5, 0.25, 0.125]], [["128/256", "1/4", "2/16"]], [["0x3f000000", "0x3e800000", "0x3e000000"]]
    drawn = {pixel_of({"draws": [{"mesh": {"colors": given}}]}).color for given in colors}
    assert len(drawn) == 1


TEXTURES = {
    "texels": {"texels": [[[200, 100, 50, 255]]]},
    "levels": {"levels": [[[[200, 100, 50, 255]]]]},
    "words": {"words": [[0xFFC86432]], "word": "A8R8G8B8"},
    "indices": {"indices": [[1]], "palette": [0, 0xFFC86432]},
    "a cube map": {"texels": [[[[200, 100, 50]]]] * 6, "target": "TEXTURE_CUBE_MAP"},
    "a volume": {"texels": [[[[200, 100, 50]]]], "target": "TEXTURE_3D"},
    "a row": {"texels": [[200, 100, 50]], "target": "TEXTURE_1D"},
}


@pytest.mark.parametrize("kind", TEXTURES)
def test_every_kind_of_texture_is_read(kind):
    unit = {"texture": "t", "sampler": {"min_filter": "NEAREST", "mag_filter": "NEAREST"}}
    unit["environment"] = {"mode": "REPLACE"}
    mesh = {"texture_coordinates": [[[0.5, 0.5, 0.5]]]}
    state = {"textures": {"t": TEXTURES[kind]}, "draws": [{"mesh": mesh, "state": {"texture_units": [unit]}}]}
    assert pixel_of(state).color == (200, 100, 50, 255)


def test_compressed_blocks_are_read():
    # Colour 0 is the 5, 6 and 5 bits of 25, 25 and 6, and every texel takes it.
    word = 25 << 11 | 25 << 5 | 6
    block = "f" * 16 + word.to_bytes(2, "little").hex() + "0000" + "00000000"
    texture = {"blocks": block, "internal_format": "COMPRESSED_RGBA_S3TC_DXT3"}
    unit = {"texture": "t", "sampler": {"min_filter": "NEAREST", "mag_filter": "NEAREST"}}
    unit["environment"] = {"mode": "REPLACE"}
    draw = {"mesh": {"texture_coordinates": [[[0.1, 0.1]]]}, "state": {"texture_units": [unit]}}
    found = pixel_of({"textures": {"t": texture}, "draws": [draw]})
    assert found.color == (25 << 3 | 25 >> 2, 25 << 2 | 25 >> 4, 6 << 3 | 6 >> 2, 255)


# -------------------------------------------------------------------------------------------- the command


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_an_example_draws_what_the_page_says(path):
    page = (DOCS / "pixel-states.md").read_text()
    result = CliRunner().invoke(main, ["pixel", str(path), "--brief"])
    assert result.exit_code == 0, result.output
    command = f"$ fixedpipe pixel docs/examples/states/{path.name} --brief\n"
    assert command + result.stdout in page


def test_there_are_examples():
    assert len(EXAMPLES) >= 4


def test_the_history_is_as_its_schema_says_and_ends_in_the_pixel():
    result = CliRunner().invoke(main, ["pixel", str(EXAMPLES[0]), "--json", "-"])
    written = json.loads(result.stdout)
    Draft202012Validator(history.json_schema()).validate(written["history"])
    assert written["color"] == written["history"]["final"]["color"]
    assert written["format"] == 1 and len(written["ideal"]) == 4


def test_a_file_is_written_and_the_terminal_has_the_stages(tmp_path):
    out = tmp_path / "pixel.json"
    assert run({"machine": "NV2A", **PIXEL}, "--json", str(out)).exit_code == 0
    assert json.loads(out.read_text())["color"] == [255, 255, 255, 255]
    text = run({"machine": "NV2A", **PIXEL}).stdout
    assert text.startswith("standard input on NV2A: color 255 255 255 255, depth 16777215, stencil 0\n")
    assert "primitive and weights" in text


def test_another_machine_may_draw_it():
    state = json.loads((DOCS / "examples" / "states" / "squared.json").read_text())
    there = run(state, "--brief").stdout
    assert there == run(state | {"machine": "NV2A"}, "--profile", "GEFORCE_256", "--brief").stdout


# -------------------------------------------------------------------------------------------- the schema


def test_the_published_schema_is_that_of_states():
    assert json.loads((DOCS / "pixel-state.schema.json").read_text()) == json_schema(), (
        "write it by: python -m fixedpipe.effects.pixel_states.schema"
    )
    Draft202012Validator.check_schema(json_schema())


def places(value, path=()):
    """Every (path, value) within JSON's values."""
    yield path, value
    below = enumerate(value) if isinstance(value, list) else getattr(value, "items", tuple)()
    for key, part in below:
        yield from places(part, (*path, key))


ODD = (
    *(None, True, -1, 0, 1, 2.5, 10**400, 2**31, "", "x", "1/0", "0x7fc00000", "LINEAR", "TEXTURE_3D"),
    *([], {}, [[]], [1], [None], [[1, 2], [3]], {"x": 1}, [[[[1]]]], "\0", "ff", "1/3"),
)


def changed(state, chance):
    """A state with one of its values replaced, removed, or given another key."""
    state = deepcopy(state)
    path, _ = chance.choice([place for place in places(state) if place[0]])
    at = state
    for key in path[:-1]:
        at = at[key]
    way = chance.randrange(3)
    if way == 0:
        del at[path[-1]]
    elif way == 1 or isinstance(at, list):
        at[path[-1]] = deepcopy(chance.choice(ODD))
    else:
        at[chance.choice(("more", "state", "mesh", "texels", "width"))] = deepcopy(chance.choice(ODD))
    return state


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_a_changed_state_is_read_or_refused_by_a_sentence_and_the_schema_takes_all_that_is_read(path):
    state, chance = json.loads(path.read_text()), random.Random(path.name)
    validator, read = Draft202012Validator(json_schema()), 0
    assert validator.is_valid(state)
    for _ in range(400):
        given = changed(state, chance)
        try:
            read_state(json.dumps(given), "it").commands(NV2A)
        except Refusal as refusal:
            assert str(refusal).endswith(".") and "\n" not in str(refusal)
            continue
        read += 1
        assert validator.is_valid(given), given
    assert 0 < read < 400


@pytest.mark.parametrize(
    "state",
    [
        {**PIXEL, "more": 1},
        {"width": 4},
        {**PIXEL, "width": 0},
        {**PIXEL, "pixel": [0]},
        {"draws": [{"state": {"blending": {"source": "SRC"}}}]},
        {"draws": [{"state": {"scissor": {"x": 0}}}]},
        {**PIXEL, "textures": {"t": {"texels": [1], "words": [1]}}},
    ],
)
def test_the_schema_refuses_what_is_no_state(state):
    validator = Draft202012Validator(json_schema())
    assert validator.is_valid(PIXEL) and not validator.is_valid(state)


# ------------------------------------------------------------------------------------------------ refusals

BAD = {
    "": "is no JSON",
    "{": "is no JSON",
    "[1]": "give an object",
    "null": "give an object",
    '{"draws": [], "draws": []}': "twice",
    '{"draws": [{"mesh": {"colors": [[NaN, 0, 0]]}}]}': "NaN",
    '{"draws": ' + "[" * 100_000: "nests its brackets",
    '{"draws": [], "width": ' + "9" * 5000 + "}": "thousands of digits",
    '{"machine": "NV2A"}': "lacks 'draws'",
    '{"machine": "NV3A", "draws": []}': "Did you mean NV2A?",
    '{"machine": "IDEAL", "draws": []}': "no machine",
    '{"draws": []}': "names no machine",
    '{"machine": "NV2A", "format": 2, "draws": []}': "this version reads format 1",
    '{"machine": "NV2A", "draws": [], "width": 513}': "1 to 512 pixels",
    '{"machine": "NV2A", "draws": [], "pixel": [1, 0]}': "outside the window",
    '{"machine": "NV2A", "draws": [], "depth_bits": 7}': "depth",
    '{"machine": "NV2A", "draws": [], "depth_bits": "FIXED"}': "names no DepthFormat",
    '{"machine": "NV2A", "draws": [1]}': "draws[0] is 1; give an object",
    '{"machine": "NV2A", "draws": [{"sate": {}}]}': "Did you mean state?",
    '{"machine": "NV2A", "draws": [{"state": {"blend": {}}}]}': "has no 'blend'. Did you mean blending?",
    '{"machine": "NV2A", "draws": [{"state": {"blending": {"source": "SRC_ALHPA"}}}]}': "SRC_ALPHA",
    '{"machine": "NV2A", "draws": [{"state": {"alpha_test": {"reference": true}}}]}': "give a number",
    '{"machine": "NV2A", "draws": [{"state": {"color_sum": 1}}]}': "give true or false",
    '{"machine": "NV2A", "draws": [{"state": {"fog": {"color": [1, 1, 1]}}}]}': "has 3 elements; give 4",
    '{"machine": "NV2A", "draws": [{"state": {"fog": {"density": "0x7fc00000"}}}]}': "finite",
    '{"machine": "NV2A", "draws": [{"state": {"scissor": {}}}]}': "lacks 'x'",
    '{"machine": "NV2A", "draws": [{"mesh": {"colors": []}}]}': "is empty",
    '{"machine": "NV2A", "draws": [{"mesh": {"colors": [[1, 1]]}}]}': "give 3 or 4 in each",
    '{"machine": "NV2A", "draws": [{"mesh": {"colors": [[1, 1, 1], [1, 1, 1]]}}]}': "has 2 rows",
    '{"machine": "NV2A", "draws": [{"mesh": {"primitive": "POINTS"}}]}': "leave primitive out",
    '{"machine": "NV2A", "draws": [{"mesh": {"window": [[0, 0]], "positions": [[0, 0]]}}]}': "one of them",
    '{"machine": "NV2A", "draws": [{"mesh": {"window": [[0, 0], [1]]}}]}': "rows of 1 and 2 numbers",
    '{"machine": "NV2A", "draws": [{"program": "!!RC1.0 {"}]}': "draws[0].program, line 1",
    '{"machine": "NV2A", "draws": [{"program": ["!!RC1.0", 1]}]}': "give a text",
    '{"machine": "NV2A", "draws": [{"state": {"texture_units": [{"texture": "t"}]}}]}': "'t'",
    '{"machine": "OPENGL_1_2", "draws": [{"program": "!!RC1.0 { rgb { spare0 = col0; } }"}]}': "combiner",
    '{"machine": "NV2A", "draws": [], "textures": []}': "an object with a texture under each name",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {}}}': "none of them",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"texels": [[[256]]]}}}': "give 0 to 255",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"texels": [[[1], [1, 2]]]}}}': "equal lengths",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"texels": [[[1, 2]]]}}}': "luminance",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"texels": [[1]]}}}': "nested 3 deep",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"words": [[1]]}}}': "no 'word'",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"words": [[1]], "word": "R6"}}}': "TexelWord",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"texels": [[[1]]], "palette": [1]}}}': "go with it",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"indices": [[0]], "palette": [1, 2, 3]}}}': "power",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"blocks": "00", '
    '"internal_format": "COMPRESSED_RGBA_S3TC_DXT1"}}}': "byte",
    '{"machine": "NV2A", "draws": [], "textures": {"t": {"blocks": "0"}}}': "give one of",
}


@pytest.mark.parametrize("text", BAD, ids=lambda text: text[:60])
def test_bad_input_ends_in_a_sentence_that_helps(text):
    result = run(text, "--brief")
    assert result.exit_code == 2, result.output
    assert BAD[text] in result.stderr
    lines = result.stderr.strip().splitlines()
    assert len([line for line in lines if line.startswith("fixedpipe: ")]) == 1
    assert "Traceback" not in result.output


def test_files_that_are_none_end_in_a_sentence(tmp_path):
    binary = tmp_path / "state.json"
    binary.write_bytes(b"\xff\xfe\x00")
    for name in (str(tmp_path / "missing.json"), str(tmp_path), str(binary)):
        result = CliRunner().invoke(main, ["pixel", name])
        assert result.exit_code == 2 and result.stderr.startswith("fixedpipe: ")
    result = run(" " * (MOST_CHARACTERS + 1))
    assert result.exit_code == 2 and "characters" in result.stderr
    assert run({"machine": "NV2A", **PIXEL}, "--brief", "--json", "x").exit_code == 2
    assert run({"machine": "NV2A", **PIXEL}, "--json", str(tmp_path)).exit_code == 2
