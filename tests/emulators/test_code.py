"""The exported C99 and GLSL: made from one source, right on every vector, and equal to our kernels."""

import hashlib
import json
import re
import shutil

import numpy as np
import pytest
from click.testing import CliRunner

from bench.peers.mesa import PeerError
from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.cli.golden import golden
from fixedpipe.effects.emulators.code import code_files, functions
from fixedpipe.effects.emulators.names import function_of
from fixedpipe.effects.emulators.sources import FOLDER, STAGES
from fixedpipe.effects.refusal import Refusal
from tests.emulators import fuzz
from tests.emulators.c99 import Library, compiler
from tests.emulators.calls import call_of, vectors_of, wrong_rows
from tests.emulators.glsl import translations
from tests.emulators.kernels import FUZZED
from tests.emulators.mesa import VERSIONS, Shaders, library, needed
from tests.layers import ROOT

pytestmark = pytest.mark.skipif(compiler() is None, reason="no C compiler here")
FUZZ = 1024  # inputs of each rule in `make test`; `python -m tests.emulators.fuzz` draws ten million
# Rules whose GLSL llvmpipe compiles for many seconds.
LONG = {"slope-of-w", "depth", "depth-of-w", "iterated-coordinate", "reflection", "polygon-offset-slope"}
QUICK = [id_ for id_ in RULES if id_ not in LONG]


@pytest.fixture(scope="module")
def c99(tmp_path_factory):
    return Library([call_of(id_) for id_ in RULES], tmp_path_factory.mktemp("c99"))


@pytest.fixture(scope="module")
def shaders():
    try:
        mesa = Shaders()
    except PeerError as reason:
        pytest.skip(str(reason))
    yield mesa
    mesa.close()


def test_the_glsl_is_what_the_c_says():
    for stage, text in translations().items():
        assert (FOLDER / f"nv2a_{stage}.glsl").read_text() == text, "python -m tests.emulators.glsl"


def test_every_rule_has_a_function_in_both_languages():
    for language in ("c99", "glsl"):
        assert functions(language).keys() == RULES.keys()
        assert functions(language)["blend-func-add"]["function"] == "nv2a_blend_func_add"


def test_the_code_has_whole_numbers_alone_and_no_library():
    for stage in STAGES:
        text = re.sub(r"/\*.*?\*/", "", (FOLDER / f"nv2a_{stage}.h").read_text(), flags=re.S)
        assert not re.search(r"\b(float|double|long|malloc|printf)\b", text), stage
        assert set(re.findall(r"#include (\S+)", text)) <= {"<stdint.h>", *(f'"nv2a_{s}.h"' for s in STAGES)}


@pytest.mark.parametrize("id_", RULES)
def test_every_vector_is_what_the_c_computes(id_, c99):
    given, expected = vectors_of(id_, 256)
    call = call_of(id_)
    assert len(wrong_rows(call, c99.run(call, given), expected)) == 0


@pytest.mark.parametrize("id_", RULES)
def test_random_inputs_are_what_the_kernels_compute(id_, c99):
    seen, wrong, first = fuzz.fuzz(c99, id_, FUZZ, seed=7)
    assert wrong == 0, first
    assert seen >= FUZZ


@pytest.mark.slow
@pytest.mark.parametrize("id_", RULES)
def test_many_random_inputs_are_what_the_kernels_compute(id_, c99):
    _, wrong, first = fuzz.fuzz(c99, id_, 200_000, seed=8)
    assert wrong == 0, first


def test_every_rule_is_fuzzed():
    assert FUZZED.keys() == RULES.keys()


def test_the_page_counts_every_vector_and_rule():
    rules = (ROOT / "docs" / "arithmetic-for-emulators.md").read_text()
    count = re.search(r"for each rule, ([\d,]+) vectors", rules)[1]
    page = (ROOT / "docs" / "code-for-emulators.md").read_text()
    assert f"| all vectors | {count} of {count}, {len(RULES)} rules |" in page
    assert f"| the same, bit for bit | {count} of {count} each |" in page
    readme = (ROOT / "README.md").read_text()
    assert f"| {count}, for {len(RULES)} rules |" in readme


# What is broken on purpose, and the rules of which a vector, or a random input, must see it.
BREAKS = (
    ("combiners", "int twice = 2 * n + 255;", "int twice = 2 * n + 240;", "rn"),
    ("rasterization", "-rest : rest) + 1023u", "-rest : rest) + 1024u", "weight-reciprocal"),
    ("vertex_programs", "(uint64_t)m) * better >> 25", "(uint64_t)m) * better >> 24", "reciprocal"),
)


@pytest.mark.parametrize(("stage", "right", "wrong", "id_"), BREAKS)
def test_a_function_that_is_wrong_is_seen(stage, right, wrong, id_, tmp_path):
    sources = tmp_path / "sources"
    shutil.copytree(FOLDER, sources)
    path = sources / f"nv2a_{stage}.h"
    text = path.read_text()
    assert text.count(right) == 1
    path.write_text(text.replace(right, wrong))
    call = call_of(id_)
    broken = Library([call], tmp_path, sources)
    given, expected = vectors_of(id_, 256)
    assert len(wrong_rows(call, broken.run(call, given), expected)) > 0
    assert fuzz.fuzz(broken, id_, 4096, seed=0)[1] > 0


# ------------------------------------------------------------------------------------------------------ GLSL


def agree(shaders, id_, version, cases):
    given, expected = vectors_of(id_, cases)
    call = call_of(id_)
    found = shaders.run(call, given, version, unsigned=id_.startswith("surface"))
    assert len(wrong_rows(call, found, expected)) == 0


@pytest.mark.parametrize(
    "id_", [*QUICK, *(pytest.param(id_, marks=pytest.mark.slow) for id_ in sorted(LONG))]
)
def test_every_vector_is_what_glsl_3_30_computes(id_, shaders):
    agree(shaders, id_, VERSIONS[0], 256)


@pytest.mark.slow
@pytest.mark.parametrize("id_", RULES)
def test_every_vector_is_what_glsl_es_3_10_computes(id_, shaders):
    agree(shaders, id_, VERSIONS[1], 256)


@pytest.mark.parametrize("version", VERSIONS)
def test_the_whole_library_compiles(version, shaders):
    call = call_of("rn")
    given, expected = vectors_of("rn", 4)
    found = shaders.run(call, given, version, library())
    assert len(wrong_rows(call, found, expected)) == 0


def test_glsl_that_is_wrong_is_seen(shaders):
    call = call_of("product")
    given, expected = vectors_of("product", 16)
    text = needed([call.function], library())
    broken = text.replace("2 * n + 255", "2 * n + 240")
    assert broken != text
    assert len(wrong_rows(call, shaders.run(call, given, VERSIONS[0], broken), expected)) > 0
    with pytest.raises(PeerError, match="does not compile"):
        shaders.run(call, given, VERSIONS[0], text.replace("int ", "into "))


# ---------------------------------------------------------------------------------------------------- export


def export(folder, *options):
    return CliRunner().invoke(golden, ["export", str(folder), *options])


@pytest.mark.parametrize(("language", "one"), [("c99", "nv2a.h"), ("glsl", "nv2a.glsl")])
def test_export_writes_code_with_its_digests(language, one, tmp_path):
    run = export(tmp_path, "--code", language)
    assert run.exit_code == 0, run.output
    index = json.loads((tmp_path / "index.json").read_text())
    for name, digest in index["files"].items():
        assert hashlib.sha256((tmp_path / name).read_bytes()).hexdigest() == digest
    assert one in index["files"]
    assert index["rules"]["rn"]["function"] == function_of("rn")
    assert (tmp_path / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    assert f"{len(RULES)} rules' functions" in run.output
    assert "MIT licence" in (tmp_path / one).read_text().splitlines()[0]


def test_exported_c_compiles_by_itself(tmp_path):
    for name, data in code_files("c99", "test").items():
        (tmp_path / name).write_bytes(data)
    call = call_of("rn")
    given, expected = vectors_of("rn", 4)
    found = Library([call], tmp_path, tmp_path).run(call, given)
    assert np.array_equal(found, expected)


def test_export_writes_the_form_of_single_step_tests(tmp_path):
    run = export(tmp_path, "--rules", "--form", "singlestep", "--cases", "1")
    assert run.exit_code == 0, run.output
    metadata = json.loads((tmp_path / "metadata.json").read_text())
    assert metadata["rules"].keys() == RULES.keys()
    for id_, known in metadata["rules"].items():
        data = (tmp_path / "v1" / f"{id_}.json").read_bytes()
        assert hashlib.sha256(data).hexdigest() == known["sha256"]
    tests = json.loads((tmp_path / "v1" / "reciprocal.json").read_text())
    assert [test["idx"] for test in tests] == list(range(len(tests)))
    known = next(test for test in tests if test["initial"] == {"x": 0x40400000})
    assert known["final"] == {"result": 0x3EAAAAAA}
    rest = {name: known[name] for name in ("name", "initial", "final")}
    assert hashlib.sha1(json.dumps(rest).encode()).hexdigest() == known["hash"]
    assert json.loads((tmp_path / "v1" / "texel-a8.json").read_text())[0]["final"]["result"] == [
        255,
        255,
        255,
        0,
    ]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--code", "c99", "--rules"), "give one of them"),
        (("--code", "c99", "--cases", "3"), "--cases would be ignored"),
        (("--form", "singlestep"), "give --rules too"),
        (("--rules", "--frames", "3"), "--frames would be ignored"),
    ],
)
def test_options_that_would_be_ignored_are_refused(options, said, tmp_path):
    run = export(tmp_path / "new", *options)
    assert isinstance(run.exception, Refusal)
    assert said in str(run.exception)
    assert not (tmp_path / "new").exists()


def test_code_is_not_written_over_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    run = export(tmp_path / "file", "--code", "glsl")
    assert isinstance(run.exception, Refusal)
