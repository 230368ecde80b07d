"""Test vectors for other renderers: the same from the same seed, and what the specification says."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from fixedpipe.effects.reports.golden.vectors import write_vectors
from fixedpipe.pipeline.enums import BlendEquation, BlendFactor
from fixedpipe.pipeline.golden import vectors
from fixedpipe.pipeline.golden.vectors import POINTS, STAGES, Chance, frame_case, stage_case
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A, OCTANE, OPENGL_1_2
from fixedpipe.pipeline.state import Blending
from tests.reference import combine, per_fragment
from tests.support.run_reference import run_reference

READER = Path(__file__).parents[3] / "docs" / "examples" / "read_vectors.c"


def test_chance_is_a_digest():
    # SHA-256 of "a:1:0" begins with these digits; written down here so that no change goes unseen.
    assert [Chance("a", 1).below(1 << 16) for _ in range(2)] == [Chance("a", 1).below(1 << 16)] * 2
    chance = Chance("a", 1)
    assert [chance.below(1000) for _ in range(3)] != [chance.below(1000) for _ in range(3)]
    import hashlib

    first = int.from_bytes(hashlib.sha256(b"a:1:0").digest()[:8], "big")
    assert Chance("a", 1).below(977) == first % 977


@pytest.mark.parametrize("stage", STAGES)
def test_a_seed_makes_one_case(stage):
    assert stage_case(stage, NV2A, 3) == stage_case(stage, NV2A, 3)
    assert stage_case(stage, NV2A, 3) != stage_case(stage, NV2A, 4)
    assert json.loads(json.dumps(stage_case(stage, NV2A, 3))) == stage_case(stage, NV2A, 3)


@pytest.mark.parametrize("seed", range(30))
def test_combiners_give_what_the_specification_says(seed):
    case = stage_case("combiners", NV2A, seed)
    program = parse_program("\n".join(f"{name} = {word}" for name, word in case["registers"].items()))
    for k in range(POINTS):
        given = {name: colors[k] for name, colors in case["inputs"].items()}
        texels = [given[f"tex{unit}"] for unit in range(4)]
        registers = combine.initial_registers(given["col0"], given["col1"], texels, [0, 0, 0, 255])
        assert (
            list(combine.combine(program.combiners, registers, combine.machine_of(NV2A)))
            == case["expected"][k]
        )


@pytest.mark.parametrize("seed", range(30))
def test_blending_gives_what_the_specification_says(seed):
    case = stage_case("blending", NV2A, seed)
    state = Blending(
        BlendFactor[case["source"]],
        BlendFactor[case["destination"]],
        BlendEquation[case["equation"]],
        tuple(component / 255 for component in case["constant"]),
    )
    pairs = zip(case["inputs"]["fragment"], case["inputs"]["stored"], case["expected"], strict=True)
    for fragment, stored, expected in pairs:
        assert list(per_fragment.blend(fragment, stored, state)) == expected


@pytest.mark.parametrize("seed", range(30))
def test_sampling_gives_what_a_texel_says(seed):
    """Nearest by its definition; of linear filters what is between the least and the greatest texel."""
    case = stage_case("sampling", NV2A, seed)
    texels, size = np.array(case["texels"]), (case["width"], case["height"])
    for (s, t), expected in zip(case["inputs"]["st"], case["expected"], strict=True):
        if case["filter"] == "LINEAR":
            assert (texels.min((0, 1)) <= expected).all() and (expected <= texels.max((0, 1))).all()
            continue
        at = []
        for value, edge, wrap in zip((s, t), size, case["wrap"], strict=True):
            index = int(np.floor(value * edge))
            at.append(index % edge if wrap == "REPEAT" else min(max(index, 0), edge - 1))
        # A picture's top row is where t is greatest.
        assert texels[size[1] - 1 - at[1], at[0]].tolist() == expected


@pytest.mark.parametrize("seed", range(4))
def test_frames_give_what_the_specification_says(seed, monkeypatch):
    kept = []

    def executed(commands, *arguments):
        kept.append((commands, *arguments))
        return execute(commands, *arguments)

    execute = vectors.execute
    monkeypatch.setattr(vectors, "execute", executed)
    _, framebuffer = frame_case(NV2A, seed)
    commands, profile, width, height = kept[-1]
    target = run_reference(commands, profile, width, height, framebuffer.depth_bits).target
    for plane in ("color", "depth", "stencil"):
        np.testing.assert_array_equal(getattr(framebuffer, plane), np.array(getattr(target, plane)))


def test_other_machines_have_vectors_of_what_they_have(tmp_path):
    assert stage_case("combiners", GEFORCE_256, 1)["inputs"].keys() == {"tex0", "tex1", "col0", "col1"}
    with pytest.raises(ValueError, match="has no register combiners"):
        stage_case("combiners", OPENGL_1_2, 1)
    with pytest.raises(ValueError, match="There are no vectors of 'fog'"):
        stage_case("fog", NV2A, 1)
    for profile in (OPENGL_1_2, OCTANE):
        assert "combiners.json" not in write_vectors(tmp_path, profile, 2, 1, 0)


def test_a_reader_in_c_agrees_and_sees_what_does_not(tmp_path):
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        pytest.skip("no C compiler here")
    written = write_vectors(tmp_path, NV2A, 60, 1, 0)
    assert sorted(written) == sorted(
        ["blending.json", "combiners.json", "sampling.json", "index.json"]
        + [f"frames/000000.{ending}" for ending in ("json", "rgba", "depth", "stencil")]
    )
    index = json.loads((tmp_path / "index.json").read_text())
    assert (index["format"], index["profile"], set(index["files"])) == (
        1,
        "NV2A",
        {*written} - {"index.json"},
    )
    program = tmp_path / "read_vectors"
    options = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-o"]
    subprocess.run([compiler, *options, program, READER], check=True)

    def run():
        return subprocess.run([program, tmp_path], capture_output=True, text=True, check=False)

    found = run()
    assert found.returncode == 0, found.stdout
    assert "frame 0: 4096 pixels" in found.stdout
    assert len(READER.read_text().splitlines()) <= 100
    text = (tmp_path / "blending.json").read_text().splitlines()
    number = next(n for n, line in enumerate(text) if '"equation": "FUNC_ADD"' in line)
    case = json.loads(text[number].rstrip(","))
    case["expected"][0][0] ^= 1
    text[number] = json.dumps(case) + ","
    (tmp_path / "blending.json").write_text("\n".join(text))
    assert run().returncode == 1
