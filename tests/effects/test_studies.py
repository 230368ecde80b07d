"""Studies: every table is measured, printed in 80 columns and plotted, and finds the numbers expected."""

import builtins
import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.acceptance.check import Check
from fixedpipe.effects.cli import main
from fixedpipe.effects.studies import STUDIES, p11_rings, p38_texture_cache
from fixedpipe.effects.studies.shared import traffic
from fixedpipe.effects.studies.shared.strips import strip
from fixedpipe.effects.studies.study import WIDTH, Column, Table
from fixedpipe.pipeline.commands import CopyPixels, Draw, TexImage
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.state import PassState, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d
from tests.support.studies import SLOW

EVERY = [pytest.param(i, marks=pytest.mark.slow) if i in SLOW else i for i in STUDIES]


def run(*arguments):
    return CliRunner().invoke(main, ["study", *map(str, arguments)])


def refusal_of(*arguments):
    """The sentence on stderr of a command that must be refused."""
    result = run(*arguments)
    assert result.exit_code == 2, result.output
    sentence = result.stderr.strip().splitlines()[-1]
    assert sentence.startswith("fixedpipe: ")
    return sentence


@pytest.fixture(scope="module")
def measured():
    """Tables by study, each measured once."""
    tables = {}

    def table(study_id):
        if study_id not in tables:
            study = STUDIES[study_id]
            own = PROFILES[study.machines[0]] if study.machines else None
            tables[study_id] = study.measure(own)
        return tables[study_id]

    return table


def without_matplotlib(monkeypatch):
    real = builtins.__import__

    def missing(name, *arguments, **named):
        if name.split(".")[0] == "matplotlib":
            raise ImportError(name)
        return real(name, *arguments, **named)

    monkeypatch.setattr(builtins, "__import__", missing)


@pytest.mark.parametrize("study_id", EVERY)
def test_a_study_finds_the_expected_numbers(study_id, measured):
    checks = tuple(STUDIES[study_id].checks(measured(study_id)))
    assert checks
    assert all(isinstance(c, Check) and c.reason for c in checks)
    assert [f"{c.name}: {c.value:.4g}, not {c.relation} {c.bound:.4g}" for c in checks if not c.passed] == []


@pytest.mark.parametrize("study_id", EVERY)
def test_a_study_s_table_fits_the_terminal_and_its_findings_have_numbers(study_id, measured):
    table = measured(study_id)
    assert all(len(row) == len(table.columns) for row in table.rows)
    assert max(map(len, table.text().splitlines())) <= WIDTH
    findings = STUDIES[study_id].findings(table)
    assert findings
    assert all(re.search(r"\d", sentence) and sentence.endswith(".") for sentence in findings)
    json.dumps(table.records(), allow_nan=False)


OTHERS = [(study.id, key) for study in STUDIES.values() for key in study.machines[1:]]


@pytest.mark.slow
@pytest.mark.parametrize(("study_id", "machine"), OTHERS)
def test_a_study_is_measured_on_every_machine_it_names(study_id, machine):
    study = STUDIES[study_id]
    table = study.measure(PROFILES[machine])
    assert max(map(len, table.text().splitlines())) <= WIDTH
    assert all(re.search(r"\d", sentence) for sentence in study.findings(table))


@pytest.mark.parametrize("study_id", STUDIES)
def test_a_study_names_machines_there_are_and_one_sentence_as_its_question(study_id):
    study = STUDIES[study_id]
    assert study.id == study_id
    assert set(study.machines) <= set(PROFILES)
    assert study.question.endswith("?")
    assert study.techniques


def test_a_printed_table_has_its_units_under_the_headings():
    columns = Column("what"), Column("bytes moved", "KB", ".1f"), Column("passes", "", "d")
    assert Table(columns, (("a", 1.25, 3), ("long name", None, 12))).text() == (
        "           bytes\n"
        "           moved\n"
        "what          KB  passes\n"
        "---------  -----  ------\n"
        "a            1.2       3\n"
        "long name      -      12"
    )


# ---------------------------------------------------------------------------- what studies measure with


def test_a_cache_drops_the_line_that_was_not_used_for_the_longest_time():
    held = p38_texture_cache.CACHE_BYTES // p38_texture_cache.LINE_BYTES
    assert p38_texture_cache.misses([0, 1, 0, 1]) == 2
    assert p38_texture_cache.misses([*range(held), *range(held)]) == held
    assert p38_texture_cache.misses([*range(held + 1), *range(held + 1)]) == 2 * (held + 1)
    # Line 0 is used again before the last one comes: 1 goes, 0 stays.
    assert p38_texture_cache.misses([*range(held), 0, held, 0]) == held + 1
    assert p38_texture_cache.misses([*range(held), 0, held, 1]) == held + 2


def test_a_filter_reads_the_lines_of_its_four_texels():
    # Blocks of 4 x 2 texels of four bytes: 4 blocks in a row of 16 texels.
    inside, corner = np.array([1.5, 4.0]) / 16, np.array([1.0, 2.0]) / 16
    assert p38_texture_cache.lines_of(inside, corner, 16, 16, 4).tolist() == [0, 0, 0, 0, 0, 1, 4, 5]
    # At the textures' edges all four are the last texel.
    edge = np.array([1.0])
    assert p38_texture_cache.lines_of(edge, edge, 16, 16, 4).tolist() == [31, 31, 31, 31]


def test_steps_of_blocks_lie_at_their_borders():
    blocks = np.arange(4.0).repeat(8)[None, :].repeat(4, axis=0)
    assert p11_rings.blockiness(blocks, 4) == 100.0
    ramp = np.arange(32.0)[None, :].repeat(4, axis=0)
    assert p11_rings.blockiness(ramp, 4) == pytest.approx(100.0 * 3 / 31)


def test_traffic_tells_what_changed_from_what_the_board_keeps():
    def frame(green, textures):
        colors = np.full((4, 3), green)
        state = PassState(texture_units=(TextureUnit("a"),))
        loads = [
            TexImage(label=name, texture=name, image=texture_2d(np.full((2, 2, 4), value, np.uint8)))
            for name, value in textures.items()
        ]
        draw = Draw(label="draw", mesh=strip(1, colors[:1], np.zeros((1, 2))), state=state)
        return (*loads, draw, CopyPixels(label="copy", width=3, height=2))

    counted = traffic.counted(frame(0.25, {"a": 1, "b": 2}), frame(0.5, {"a": 1, "b": 3}))
    # Texture a, four positions of two floats and as many texture coordinates stay.
    assert counted["kept"] == 16 + 2 * 4 * 2 * 4
    assert (counted["loaded"], counted["loads"]) == (16, 1)
    assert counted["vertices"] == 4 * 4
    assert (counted["copied"], counted["copies"]) == (2 * 3 * 2 * 4, 1)
    assert counted["passes"] == 1


# --------------------------------------------------------------------------------------- the command line


def test_without_an_id_the_studies_are_listed():
    result = run()
    assert [line.split()[0] for line in result.stdout.splitlines()] == list(STUDIES)


@pytest.mark.parametrize("ids", [(), ("all",), ("P9", "all")])
def test_all_studies_are_checked_without_an_id(ids, tmp_path, monkeypatch):
    monkeypatch.setattr(STUDIES, "_modules", {key: STUDIES.module_of(key) for key in ("P9", "P10")})
    result = run(*ids, "--check", "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert "2 studies in" in result.stdout and result.stdout.count("ok ") > 2
    assert {path.stem for path in tmp_path.glob("*.json")} == {"P9", "P10"}


def test_a_missed_number_of_any_study_is_found_without_an_id(tmp_path, monkeypatch):
    from fixedpipe.effects.studies import p09_nine_bit_registers

    monkeypatch.setattr("fixedpipe.effects.studies.STUDIES", {"P9": STUDIES["P9"]})
    monkeypatch.setattr(p09_nine_bit_registers, "_CATALOGUED", {(1.0, 1.0, True): 0.1})
    assert run("--check", "--out", tmp_path).exit_code == 1


def test_an_unknown_study_is_refused_beside_all():
    assert "There is no study 'P99'" in refusal_of("all", "P99")


def test_a_study_prints_its_table_and_writes_its_plot_and_record(tmp_path):
    pytest.importorskip("matplotlib")
    results = tmp_path / "all.json"
    result = run("P9", "--check", "--out", tmp_path, "--json", results, "--csv", tmp_path / "all.csv")
    assert result.exit_code == 0, result.output
    assert max(map(len, result.stdout.split("ok ")[0].splitlines())) <= WIDTH
    record = json.loads((tmp_path / "P9.json").read_text())
    assert json.loads(results.read_text()) == [record]
    table = list(csv.DictReader((tmp_path / "all.csv").read_text().splitlines()))
    assert table == [{name: str(value) for name, value in row.items()} for row in record["rows"]]
    assert record["profile"] == "GEFORCE_256"
    assert record["rows"][0]["RMS of all"] > 0.0
    assert all(c["passed"] for c in record["checks"])
    assert result.stdout.count("ok ") == len(record["checks"])
    picture = np.asarray(Image.open(tmp_path / record["plot"]))
    assert len(np.unique(picture.reshape(-1, picture.shape[-1]), axis=0)) > 50


def test_the_same_study_writes_the_same_bytes_again(tmp_path):
    pytest.importorskip("matplotlib")
    for name in ("a", "b"):
        assert run("P9", "--out", tmp_path / name).exit_code == 0
    for file in ("P9.png", "P9.json"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_a_study_is_measured_on_another_machine(tmp_path):
    assert run("P9", "--profile", "GEFORCE_3", "--out", tmp_path).exit_code == 0
    assert json.loads((tmp_path / "P9.json").read_text())["profile"] == "GEFORCE_3"


def test_a_missed_number_sets_exit_status_1(tmp_path, monkeypatch):
    from fixedpipe.effects.studies import p09_nine_bit_registers

    monkeypatch.setattr(p09_nine_bit_registers, "_CATALOGUED", {(1.0, 1.0, True): 0.1})
    result = run("P9", "--check", "--out", tmp_path)
    assert result.exit_code == 1
    assert "FAILED RMS of all" in result.stdout
    assert "1 expected number missed" in result.stderr


def test_an_unknown_study_is_refused_with_the_likely_one():
    assert "Did you mean P9?" in refusal_of("p9")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("P9", "--profile", "OCTANE"), "P9 cannot be measured on OCTANE; give one of GEFORCE_256"),
        (("P9", "--profile", "VOODOO"), "GEFORCE_256"),
        (("P9", "--profile", "IDEAL"), "IDEAL is no machine"),
        (
            ("P9", "P10", "--csv", "a.csv"),
            "A CSV file has one table, and these are 2; give one ID, or --json.",
        ),
        (("P9", "--profile", "GEFORCE_3", "--check"), "expected numbers of P9 are for GEFORCE_256"),
    ],
)
def test_what_does_not_fit_a_study_is_refused(arguments, said, tmp_path):
    assert said in refusal_of(*arguments, "--out", tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_an_output_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "taken").write_text("")
    assert "cannot be written to" in refusal_of("P9", "--out", tmp_path / "taken")


def test_without_matplotlib_the_table_is_printed_and_the_refusal_says_what_to_install(tmp_path, monkeypatch):
    without_matplotlib(monkeypatch)
    result = run("P9", "--out", tmp_path)
    assert result.exit_code == 0
    assert "share in" in result.stdout
    assert "pip install 'fixedpipe[plots]'" in result.stderr
    assert (tmp_path / "P9.json").is_file()
    assert not (tmp_path / "P9.png").exists()


def test_the_page_of_studies_has_a_section_for_each():
    page = (Path(__file__).parents[2] / "docs" / "studies.md").read_text()
    assert re.findall(r"^### (P\d+)$", page, re.MULTILINE) == list(STUDIES)
