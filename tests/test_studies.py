"""Studies: every table is measured, printed in 80 columns and plotted, and finds the numbers expected."""

import builtins
import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from effects.cli import main
from effects.figures import Check
from effects.studies import STUDIES
from effects.studies.study import WIDTH, Column, Table
from pipeline.profiles import PROFILES

# Studies that take longer than about half a second.
SLOW = {"P11", "P19", "P32", "P38", "P40"}
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
    checks = STUDIES[study_id].checks(measured(study_id))
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


# --------------------------------------------------------------------------------------- the command line


def test_without_an_id_the_studies_are_listed():
    result = run()
    assert [line.split()[0] for line in result.stdout.splitlines()] == list(STUDIES)


def test_a_study_prints_its_table_and_writes_its_plot_and_record(tmp_path):
    pytest.importorskip("matplotlib")
    results = tmp_path / "all.json"
    result = run("P9", "--check", "--out", tmp_path, "--json", results)
    assert result.exit_code == 0, result.output
    assert max(map(len, result.stdout.split("ok ")[0].splitlines())) <= WIDTH
    record = json.loads((tmp_path / "P9.json").read_text())
    assert json.loads(results.read_text()) == [record]
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
    from effects.studies import p9

    monkeypatch.setattr(p9, "_CATALOGUED", {(1.0, 1.0, True): 0.1})
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
        (("P9", "--profile", "GEFORCE_3", "--check"), "expected numbers of P9 are for GEFORCE_256"),
    ],
)
def test_a_machine_that_does_not_fit_is_refused(arguments, said, tmp_path):
    assert said in refusal_of(*arguments, "--out", tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_an_output_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "taken").write_text("")
    assert "cannot be written to" in refusal_of("P9", "--out", tmp_path / "taken")


def test_without_matplotlib_the_table_is_printed_and_the_refusal_says_what_to_install(tmp_path, monkeypatch):
    without_matplotlib(monkeypatch)
    result = run("P9", "--out", tmp_path)
    assert result.exit_code == 2
    assert "share in" in result.stdout
    assert "pip install 'fixedpipe[plots]'" in result.stderr
    assert (tmp_path / "P9.json").is_file()
    assert not (tmp_path / "P9.png").exists()


def test_the_page_of_studies_has_a_line_for_each():
    page = (Path(__file__).parents[1] / "docs" / "studies.md").read_text()
    assert re.findall(r"^\| (P\d+) \|", page, re.MULTILINE) == list(STUDIES)
