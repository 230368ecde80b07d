"""Another renderer beside ours, open rules that captures may decide, and what drew a wrong pixel."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from fixedpipe.effects.conformance import redraw
from fixedpipe.effects.conformance.case import HEIGHT, WIDTH, Case, Inputs
from fixedpipe.effects.conformance.redraw import Comparison
from fixedpipe.effects.conformance.rules import RULES, distinction, fragments_that_differ
from fixedpipe.effects.conformance.scoreboard import Row, Score, row_of
from fixedpipe.effects.reports.scoreboard_page import CAPTURES, SHOWN, ScoreboardPage
from fixedpipe.pipeline.commands import Clear, Draw, Mesh
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.profiles import GEFORCE_256, NV2A
from fixedpipe.pipeline.state import PassState
from fixedpipe.pipeline.validation.validate import validate_program
from tests.conformance.test_conformance import conformance, refusal
from tests.layers import ROOT

SUITE, NAME = "Alpha_func", "AlphaFuncNotEqual_Enabled"
WHOLE = WIDTH * HEIGHT


@pytest.fixture(scope="module")
def ours():
    blank = np.zeros((HEIGHT, WIDTH, 4), np.uint8)
    return redraw.compare(SUITE, redraw.known_suites()[SUITE], NAME, blank, Inputs(None)).ours


def saved(folder, image, suite=SUITE, name=NAME):
    (folder / suite).mkdir(parents=True, exist_ok=True)
    Image.fromarray(image).save(folder / suite / f"{name}.png")


@pytest.fixture
def folders(tmp_path, ours):
    """Captures, one of which is not drawn by us as it is, and another renderer's pictures of them."""
    captures, other = tmp_path / "results", tmp_path / "theirs"
    captured, drawn = ours.copy(), ours.copy()
    captured[300, 200, 2] ^= 1
    drawn[:2, :3, 0] ^= 1
    drawn[400, 5, 3] ^= 64
    saved(captures, captured)
    saved(captures, ours, name="AlphaFuncNotEqual_Disabled")
    saved(other, drawn)
    return captures, other


def test_a_score_counts_pixels_where_it_may():
    captured = np.zeros((2, 3, 4), np.uint8)
    drawn, mask = captured.copy(), np.ones((2, 3), bool)
    drawn[0, 0, 3], drawn[0, 1, 1], drawn[1, 2, 0] = 1, 9, 200
    mask[1, 2] = False
    assert Score.of(drawn, captured, mask) == Score(1, 0, 5, 3, 4, 9, 0)
    assert Score.of(captured, captured, mask) == Score(1, 1, 5, 5, 5, 0, 0)
    both = Row(Score(1, 0, 5, 3, 4, 9)) + Row(Score(1, 1, 5, 5, 5, 0), Score(missing=1))
    assert both == Row(Score(2, 1, 10, 8, 9, 9), Score(missing=1))


def test_another_renderer_is_counted_beside_ours(folders, tmp_path):
    captures, other = folders
    html, record = tmp_path / "out.html", tmp_path / "out.json"
    result = conformance(captures, "--other", other, "--html", html, "--json", record)
    assert result.exit_code == 0, result.output
    (row,) = (line for line in result.stdout.splitlines() if line.startswith(f"{SUITE}  "))
    # Ours: one pixel off by 1; the other's: that one, six by 1 and one by 64. Of one capture it has no
    # picture.
    assert row.split() == [
        SUITE,
        *(["0", "of", "1"]),
        f"{(WHOLE - 1) / WHOLE:.4%}",
        "100.0000%",
        "1",
        *(["0", "of", "1"]),
        f"{(WHOLE - 8) / WHOLE:.4%}",
        f"{(WHOLE - 1) / WHOLE:.4%}",
        "64",
        *(["1", "without", "a", "picture"]),
    ]
    found = {entry["case"]: entry["other"] for entry in json.loads(record.read_text())}
    assert found[NAME] == {"equal": WHOLE - 8, "within_one": WHOLE - 1, "largest": 64, "missing": 0}
    assert found["AlphaFuncNotEqual_Disabled"]["missing"] == 1
    assert "Beside another renderer" in html.read_text()


def test_the_scoreboard_is_a_page_that_can_be_published(folders, tmp_path):
    captures, other = folders
    page = tmp_path / "page.html"
    assert conformance(captures, "--other", other, "--page", page).exit_code == 0
    text = page.read_text()
    assert "<title>theirs beside a real NV2A</title>" in text
    assert f"{WHOLE - 8:,} of {WHOLE:,}" in text and f"{WHOLE - 1:,} of {WHOLE:,}" in text
    assert f"<h3>{SUITE}/{NAME}: 8 pixels differ</h3>" in text
    assert "It has no picture of 1 capture; these count for neither." in text
    # It needs nothing from elsewhere, and says nothing of this computer.
    assert "<script" not in text and 'src="data:image/png;base64,' in text
    assert re.findall(r'(?:href|src)="(?!data:)([^"]*)"', text) == [CAPTURES]
    assert str(tmp_path) not in text


def test_a_page_keeps_the_worst_cases_and_a_name_is_only_text():
    page, theirs = ScoreboardPage("<b>&"), np.zeros((8, 8, 4), np.uint8)
    for count in (*range(1, SHOWN + 4), 2):
        drawn = theirs.copy()
        drawn.reshape(-1, 4)[:count] = 9
        c = comparison(theirs, theirs)
        c = replace(c, name=f"c{count}")
        page.add(c, row_of(c, drawn), drawn)
    page.add(c, row_of(c, None), None)
    found = re.findall(r"<h3>S/c(\d+): ", page.text())
    assert [int(n) for n in found] == list(range(SHOWN + 3, 3, -1))
    assert "<b>&" not in page.text() and "&lt;b&gt;&amp; beside" in page.text()


def test_a_page_needs_another_renderer(folders, tmp_path):
    captures, other = folders
    assert "give --other DIR" in refusal(captures, "--page", tmp_path / "page.html")
    twice = tmp_path / "x.html"
    refused = refusal(captures, "--other", other, "--page", twice, "--html", twice)
    assert "--html and --page both name" in refused


def test_other_pictures_that_are_none_are_said(folders, tmp_path):
    captures, other = folders
    assert "There is no folder 'nowhere'" in refusal(captures, "--other", "nowhere")
    (other / SUITE / f"{NAME}.png").write_bytes(b"no picture")
    refused = conformance(captures, "--other", other)
    assert (refused.exit_code, "it is no whole picture" in refused.stderr) == (2, True)
    Image.new("RGBA", (320, 240)).save(other / SUITE / f"{NAME}.png")
    assert "2 without a picture" in conformance(captures, "--other", other).stdout


def test_what_drew_a_wrong_pixel_is_told(folders):
    captures, _ = folders
    said = conformance(captures, "--explain").stdout
    assert "worst at (200, 300): ours" in said
    assert "last changed by command" in said
    assert "final combiner: color" in said
    assert said.count("worst at (200, 300)") == 1


def test_processes_give_the_same_as_threads(folders):
    captures, _ = folders
    threads, jobs = (conformance(captures, *given).stdout for given in (("--threads", "1"), ("--jobs", "2")))
    assert threads == jobs
    assert "give one of them" in refusal(captures, "--jobs", "2", "--threads", "2")


# -------------------------------------------------------------------------------------------------- rules


def test_rules_can_be_listed_without_captures():
    said = conformance("--discriminates", "list").stdout
    assert all(name in said for name in RULES)


def test_a_rule_that_is_none_is_said(folders):
    captures, _ = folders
    assert "Did you mean final-lerp?" in refusal(captures, "--discriminates", "final-lerb")
    assert "Leave them out" in refusal(captures, "--discriminates", "final-lerp", "--explain")


def test_a_changed_machine_changes_what_the_rule_says():
    for name, rule in RULES.items():
        assert (rule.changed is None) == bool(rule.stage), name
        if rule.changed is not None:
            assert rule.changed.facts != NV2A.facts, name


# What the rivals that no profile has make of a probe: of code that computes as the question says.
RIVALS = {
    "half-bias": (int((150 - 127.5) * 4), (150 - 127) * 4),
    "negative-products": (-4 * -(200 // 255),),
    "final-words-zero": (100,),
    "final-lerp": ((2 * 100 + 255) // 510 + (2 * 155 * 2 + 255) // 510,),
}


def probed(probe, profile):
    """What a probe's fragments are on a machine."""
    return pixels_of(parse_program(probe.text).combiners, probe.primary, profile)


def pixels_of(combiners, primary, profile):
    """The red, green and blue that combiners make of a primary colour of that byte on a machine."""
    validate_program(None, combiners, profile)
    vertices = Mesh(
        np.array([[0.0, 0.0, 0.0, 1.0]]),
        PrimitiveType.POINTS,
        colors=np.full((1, 4), primary / 255),
    )
    state = PassState(register_combiners=combiners)
    return (
        execute((Draw(label="probe", mesh=vertices, state=state),), profile, 1, 1).image()[0, 0, :3].tolist()
    )


@pytest.mark.parametrize("name", [name for name, rule in RULES.items() if rule.probe])
def test_a_probe_draws_what_it_says(name):
    rule, probe = RULES[name], RULES[name].probe
    for profile in (NV2A, GEFORCE_256):
        assert probed(probe, profile) == [probe.stands] * 3
    if rule.changed is not None:
        assert probed(probe, rule.changed) == [*probe.otherwise] * 3
    else:
        assert RIVALS[name] == probe.otherwise
    assert probe.stands not in probe.otherwise
    page = (ROOT / "docs" / "silicon.md").read_text()
    otherwise = " or ".join(map(str, probe.otherwise))
    assert f"| `{name}` | `{probe.text}` | {probe.primary} | {probe.stands} | {otherwise} |" in page


def comparison(image, theirs):
    return Comparison(
        suite="S",
        name="N",
        theirs=theirs,
        ours=image,
        compared=np.ones(image.shape[:2], bool),
        equal=(image == theirs).all(-1),
    )


def test_a_capture_tells_where_two_machines_differ():
    theirs = np.zeros((4, 4, 4), np.uint8)
    stands, otherwise = theirs.copy(), theirs.copy()
    assert distinction(comparison(stands, theirs), comparison(otherwise, theirs)) is None
    otherwise[0, :2, 0] = 1
    stands[1, 1, 2] = 7
    found = distinction(comparison(stands, theirs), comparison(otherwise, theirs))
    assert (found.pixels, found.as_it_stands, found.otherwise) == (3, 2, 1)
    assert distinction(comparison(stands, theirs), Comparison(suite="S", name="N", theirs=theirs)) is None


def drawn_by(program, colors):
    mesh = Mesh(
        [[-1, -1], [3, -1], [-1, 3]],
        PrimitiveType.TRIANGLES,
        colors=np.array([colors] * 3) / 255,
        secondary_colors=np.array([[200, 100, 50, 255]] * 3) / 255,
    )
    state = PassState(register_combiners=parse_program(f"!!RC1.0\n{program}").combiners)
    return Case(commands=(Clear(label="c", color=(0, 0, 0, 0)), Draw(label="d", mesh=mesh, state=state)))


PLAIN = "{ rgb { spare0 = col0; } } out.rgb = spare0;"
LERP = "{ rgb { spare0 = col0; } } out.rgb = lerp(col0.a, col0, col1);"


@pytest.mark.parametrize(
    ("name", "program", "alpha", "differs"),
    [
        ("final-lerp", PLAIN, 128, False),
        ("final-lerp", LERP, 0, False),
        ("final-lerp", LERP, 128, True),
        ("half-bias", PLAIN, 255, False),
        ("half-bias", "{ rgb { spare0 = half_bias(col0); } } out.rgb = spare0;", 255, True),
        ("negative-products", PLAIN, 255, False),
        ("negative-products", "{ rgb { spare0 = -col0 * col1; } } out.rgb = spare0;", 255, True),
    ],
)
def test_fragments_that_a_rule_concerns_are_counted(name, program, alpha, differs):
    case = drawn_by(program, [30, 77, 9, alpha])
    assert bool(fragments_that_differ(case, RULES[name])) == differs
