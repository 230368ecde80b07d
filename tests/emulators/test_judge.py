"""``fixedpipe golden judge``: what a program has right, and every way in which one does not answer."""

import json
import resource
import subprocess
import sys

import pytest
from click.testing import CliRunner

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.cli.golden import golden
from fixedpipe.effects.emulators.code import code_files
from fixedpipe.effects.emulators.judge import judge_rule, same
from fixedpipe.effects.refusal import Refusal
from tests.emulators.c99 import compiler
from tests.layers import ROOT

EXAMPLE = ROOT / "docs" / "examples" / "judged.c"
ANSWERED = {"rn", "product", "signed-texel", "general-clamp", "final-lerp", "blend-func-add", "filter-step"}
_HURRIED, _PATIENT = 1.0, 120.0


def judged(script, id_="rn", patience=_PATIENT):
    """The score of a shell script."""
    return judge_rule(["/bin/sh", "-c", script], RULES[id_], 2, 0, patience)


# ------------------------------------------------------------------------------------ what cannot be judged


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("yes garbage", "It answers case 0 with what is no JSON: 'garbage'."),
        ("yes '[[[['", "no JSON"),
        ("yes '3'", 'It answers case 0 without a "result".'),
        ("""yes '{"result": 1, "case": 7}'""", "It answers case 0 with case 7; answers keep the order"),
        ("tr '\\0' a < /dev/zero", "It answers case 0 with a line of more than 65536 bytes."),
        ("exit 3", "It ended with status 3 before case 0."),
        ("echo no luck >&2; exit 1", "It ended with status 1 before case 0, and said: no luck"),
        ("kill -SEGV $$", "It crashed with signal 11 (Segmentation fault) before case 0."),
        ("""echo '{"result": 0}'; exit 0""", "It ended with status 0 before case 1."),
        ("exec <&-; exit 0", "It ended with status 0 before case 0."),
        ("head -c 100000000 /dev/zero >&2; exit 5", "It ended with status 5 before case 0"),
    ],
)
def test_a_program_that_does_not_answer_is_said_in_a_sentence(script, said):
    score = judged(script)
    assert said in score.failure
    assert not score.whole


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("sleep 600", "It hangs: no answer to case 0 came within 1 seconds."),
        ("cat > /dev/null; sleep 600", "It hangs: no answer to case 0"),
        ("exec 1>&-; sleep 600", "It closed its output before case 0, and goes on."),
    ],
)
def test_a_program_that_waits_is_ended(script, said):
    assert said in judged(script, patience=_HURRIED).failure


def test_what_a_program_writes_is_not_kept():
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert judged("cat /dev/zero").failure
    assert judged("cat /dev/zero >&2", patience=_HURRIED).failure
    assert judged("""yes '{"result": 0}'""").vectors > 0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 64 << 10, "KiB"


def test_a_program_that_is_none_is_refused():
    for name in ("/nonexistent", str(ROOT), "a\0b"):
        with pytest.raises(Refusal, match="cannot be started"):
            judge_rule([name], RULES["rn"], 0, 0, _PATIENT)


def test_null_is_no_answer():
    script = """while read -r line; do echo '{"result": null}'; done"""
    score = judged(script)
    assert (score.absent, score.first, score.failure, score.whole) == (True, None, "", False)


# ------------------------------------------------------------------------------------------------- values


@pytest.mark.parametrize(
    ("kind", "expected", "answered", "right"),
    [
        ("int", 3, 3, True),
        ("int", 3, 3.0, False),
        ("int", 1, True, False),
        ("int", 3, "3", False),
        ("single", "0x3f800000", "0x3F800000", True),
        ("single", "0x3f800000", 0x3F800000, True),
        ("single", "0x3f800000", 1.0, False),
        ("single", "0x00000000", "0x80000000", False),
        ("single", "NaN", "0xffc00001", True),
        ("single", "NaN", "0x7f800000", False),
        ("single", "0x3f800000", "NaN", False),
        ("single", "0x3f800000", "no number", False),
        ("double", "NaN", "NaN", True),
        ("double", "0x3ff0000000000000", "0x3ff0000000000000", True),
        ("int[3]", [1, 2, 3], [1, 2, 3], True),
        ("int[3]", [1, 2, 3], [1, 2], False),
        ("int[3]", [1, 2, 3], 1, False),
        ("bytes", "00ff", "00FF", True),
        ("bytes", "00ff", 255, False),
    ],
)
def test_an_answer_is_compared_to_the_bit(kind, expected, answered, right):
    assert same(kind, expected, answered) == right


# -------------------------------------------------------------------------------------------- the scorecard


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    """The example, right and wrong."""
    if compiler() is None:
        pytest.skip("no C compiler here")
    folder = tmp_path_factory.mktemp("judged")
    for name, data in code_files("c99", "test").items():
        (folder / name).write_bytes(data)
    for name, options in (("right", ()), ("wrong", ("-DWRONG",))):
        command = [compiler(), "-std=c99", "-Wall", "-Werror", "-O1", *options, f"-I{folder}", "-o"]
        subprocess.run([*command, folder / name, EXAMPLE], check=True)
    return folder


def test_the_example_is_right_and_a_wrong_one_is_seen(programs, tmp_path):
    chosen = [argument for id_ in (*sorted(ANSWERED), "reciprocal") for argument in ("--rule", id_)]
    found = {}
    for name in ("right", "wrong"):
        files = tmp_path / f"{name}.json", tmp_path / f"{name}.html"
        options = [
            "judge",
            *chosen,
            "--cases",
            "16",
            "--patience",
            "120",
            "--json",
            files[0],
            "--html",
            files[1],
        ]
        run = CliRunner().invoke(golden, [*map(str, options), str(programs / name)])
        assert run.exit_code == 1, run.output  # the example lacks a rule
        found[name] = json.loads(files[0].read_text())
        assert "reciprocal" in run.output
        assert "not answered" in run.output
        page = files[1].read_text()
        assert page.count("<tr class=") == len(ANSWERED) + 1
        assert "http" not in page, "the page needs no network"
    by_rule = {name: {rule["rule"]: rule for rule in record["rules"]} for name, record in found.items()}
    assert {id_ for id_, rule in by_rule["right"].items() if rule["right"] == rule["vectors"]} == ANSWERED
    assert by_rule["right"]["reciprocal"]["absent"]
    wrong = {id_ for id_, rule in by_rule["wrong"].items() if rule["first"]}
    assert wrong == {"rn", "product", "signed-texel"}
    first = by_rule["wrong"]["signed-texel"]["first"]
    assert first == {"case": 1, "inputs": {"byte": 1}, "expected": 2, "answered": 1}
    totals = found["wrong"]["totals"]
    assert (totals["rules"], totals["whole"], totals["absent"], totals["failed"]) == (8, 4, 1, 0)
    assert sum(tag["rules"] for tag in totals["by_evidence"].values()) == 8


def test_a_program_that_has_every_vector_is_whole(tmp_path):
    """It asks the rules themselves, so it proves the judge, and nothing of them."""
    program = tmp_path / "knows.py"
    program.write_text(
        "import json, sys\n"
        "from fixedpipe.effects.arithmetic.rules import RULES\n"
        "known = {}\n"
        "for line in sys.stdin:\n"
        "    asked = json.loads(line)\n"
        "    cases = known.setdefault(asked['rule'], list(RULES[asked['rule']].cases(2, 5)))\n"
        "    print(json.dumps({'result': cases[asked['case']]['expected']}), flush=True)\n"
    )
    for id_ in ("dxt5", "vertex-mul"):
        score = judge_rule([sys.executable, str(program)], RULES[id_], 2, 5, _PATIENT)
        assert score.whole, score
    assert not judge_rule([sys.executable, str(program)], RULES["dxt5"], 2, 6, _PATIENT).whole


def test_a_rule_that_is_none_is_refused():
    run = CliRunner().invoke(golden, ["judge", "--rule", "rm", "/bin/true"])
    assert isinstance(run.exception, Refusal)
    assert "no rule 'rm'" in str(run.exception)
