"""Sweeps by the command line: rows, files, what is found again, and what cannot be done."""

import csv
import json
import math
import os
import re
import subprocess
import sys

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.sweeps import points
from fixedpipe.effects.sweeps.sweep import sweep
from fixedpipe.effects.sweeps.tables import columns_of
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.profiles import GEFORCE_256

GRID = "sweep", "K12", "--vary", "depth=0:0.4:3", "--vary", "bits=6:7", "--size", "8"


def run(*arguments, status=0):
    done = CliRunner().invoke(main, [str(a) for a in arguments])
    assert done.exit_code == status, done.output
    return done


def refusal(*arguments):
    lines = run(*arguments, status=2).stderr.splitlines()
    return lines[-1]


def table(path):
    header, *rows = csv.reader(path.read_text().splitlines())
    return [dict(zip(header, row, strict=True)) for row in rows]


def test_a_row_has_what_the_figure_gives():
    (row,) = sweep("K12", {"depth": "0.2", "bits": "7"}, size=8).rows(times=True)
    machine = GEFORCE_256.with_precision(combiner_bits=7, texture_bits=7, framebuffer_bits=7)
    drawn = FIGURES["K12"].render(
        machine.with_precision(filter_fraction_bits=7), 8, method=FIGURES["K12"].methods[0], depth=0.2
    )
    assert row["sha256"] == digest(drawn.image()) and row["differing"] == drawn.difference.pixels
    assert row["rms"] == 255.0 * drawn.difference.rms > 0.0
    assert row["largest"] == 255.0 * drawn.difference.largest
    assert list(row)[:6] == ["figure", "machine", "depth", "bits", "width", "height"]
    assert row["seconds"] > 0.0 and re.fullmatch(r".+:\d+", row["worker"]) and row["refused"] is None


def test_a_sweep_is_found_again_and_a_larger_one_goes_on(tmp_path, monkeypatch):
    drawn, point = [], points.figure_point
    out = tmp_path / "a.csv"

    def counted(**what):
        drawn.append((what["changes"]["depth"], what["bits"]))
        return point(**what)

    counted.__module__, counted.__qualname__ = point.__module__, point.__qualname__
    monkeypatch.setattr("fixedpipe.effects.sweeps.sweep.figure_point", counted)
    said = run(*GRID, "--out", out)
    assert "A sweep of K12: 6 points (1 machine x 3 depth x 2 bits), here." in said.stderr
    assert drawn == [(d, b) for d in ("0", "0.2", "0.4") for b in (6, 7)]
    first = out.read_bytes()
    said = run(*GRID, "--out", out)
    assert "the manifest has 6 finished points" in said.stderr and out.read_bytes() == first
    larger = [part.replace("bits=6:7", "bits=6:8") for part in GRID]
    drawn.clear()
    run(*larger, "--out", out)
    assert drawn == [("0", 8), ("0.2", 8), ("0.4", 8)]
    assert [row for row in table(out) if row["bits"] != "8"] == [dict(r) for r in _parsed(first)]
    drawn.clear()
    run(*GRID, "--out", out, "--again")
    assert len(drawn) == 6


def _parsed(data):
    header, *rows = (line.split(",") for line in data.decode().splitlines())
    return [dict(zip(header, row, strict=True)) for row in rows]


def test_two_processes_write_the_bytes_of_one(tmp_path):
    both = ("--no-times", "--pictures")
    run(*GRID, "--out", tmp_path / "one.csv", *both, tmp_path / "one")
    run(*GRID, "--out", tmp_path / "two.csv", *both, tmp_path / "two", "--executor", "processes:2")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    pictures = {path.name: path.read_bytes() for path in (tmp_path / "one").iterdir()}
    assert pictures == {path.name: path.read_bytes() for path in (tmp_path / "two").iterdir()}
    for row in table(tmp_path / "one.csv"):
        shown = np.asarray(Image.open(tmp_path / "one" / row["picture"]))
        assert shown.shape == (8, 16, 4) or shown.shape == (8, 16, 3)
    (tmp_path / "one" / row["picture"]).unlink()
    run(*GRID, "--out", tmp_path / "one.csv", *both, tmp_path / "one")
    assert (tmp_path / "one" / row["picture"]).read_bytes() == pictures[row["picture"]]


def test_tables_read_as_what_was_written(tmp_path):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    pytest.importorskip("pyarrow"), pytest.importorskip("netCDF4")
    for ending in ("csv", "parquet", "nc"):
        manifest = "--manifest", tmp_path / "m"
        run(*GRID, "--out", tmp_path / f"a.{ending}", *manifest, "--no-times")
    plain = pandas.read_csv(tmp_path / "a.csv")
    parquet = pandas.read_parquet(tmp_path / "a.parquet")
    assert list(plain) == list(parquet) and len(parquet) == 6
    for name in ("depth", "bits", "rms", "differing", "sha256"):
        assert plain[name].tolist() == parquet[name].tolist()
    with xarray.open_dataset(tmp_path / "a.nc", engine="netcdf4") as grid:
        assert dict(grid.sizes) == {"machine": 1, "depth": 3, "bits": 2}
        row = parquet.iloc[3]
        there = grid.sel(machine="GEFORCE_256", depth=row["depth"], bits=int(row["bits"]))
        assert float(there["rms"]) == row["rms"] and str(there["sha256"].values) == row["sha256"]
        assert grid.attrs["title"] == "a sweep of K12"


def test_columns_have_one_type():
    rows = [{"a": 1, "b": None, "z": "x"}, {"a": 1.5, "c": True, "b": None}, {"a": None, "c": "no"}]
    assert columns_of(rows, ("z", "not there")) == {"a": float, "b": str, "c": str, "z": str}


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_plot_of_one_axis_and_of_two(tmp_path, ending):
    pytest.importorskip("matplotlib")
    for grid in (GRID, ("sweep", "K12", "--vary", "depth=0:0.4:3", "--size", "8")):
        plots = []
        for _ in range(2):
            run(*grid, "--out", tmp_path / "a.csv", "--plot", tmp_path / f"a.{ending}")
            plots.append((tmp_path / f"a.{ending}").read_bytes())
        assert plots[0] == plots[1] and len(plots[0]) > 4000


def test_checks_are_counted_by_bits():
    rows = sweep("K12", {"bits": "4,8"}, checks=True, size=16).rows()
    assert [row["checks"] > 0 for row in rows] == [True, True]
    few, all_of_them = rows
    assert few["failed_checks"] > all_of_them["failed_checks"] == 0
    assert few["failed_names"].count("; ") == few["failed_checks"] - 1


def test_a_study_has_a_row_for_each_of_its_table(tmp_path):
    known = STUDIES["P32"].measure(None if not STUDIES["P32"].machines else GEFORCE_256)
    rows = sweep("P32", {}).rows()
    assert len(rows) == len(known.rows)
    for row, own in zip(rows, known.records(), strict=True):
        for name, value in own.items():
            there = row.get(f"{name} (table)", row[name])
            assert there == value or (there is None and not math.isfinite(value))
    # A table of several rows is no grid.
    pytest.importorskip("xarray")
    said = refusal("sweep", "P32", "--out", tmp_path / "a.nc")
    assert "Name the file .csv or .parquet" in said


SCRIPT = """
from fixedpipe.pipeline import Draw, Mesh, PassState, parse_program

profile, width, height = "GEFORCE_256", 4, 4
PROGRAM = "!!RC1.0 { rgb { spare0 = col0 * col0; } } out.rgb = spare0; out.a = unsigned_invert(zero);"
SQUARED = PassState(register_combiners=parse_program(PROGRAM).combiners)


def commands(red, blue=0.5):
    mesh = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[red, 0.5, blue]] * 3)
    return [Draw(label="squared", mesh=mesh, state=SQUARED)]


def measure(result, ideal, red, blue=0.5):
    return {"error": float(result.image()[0, 0, 0] / 255 - red * red), "nothing": float("nan")}
"""


def test_a_script_is_drawn_over_what_its_commands_take(tmp_path):
    script = tmp_path / "mine.py"
    script.write_text(SCRIPT)
    vary = "--vary", "red=0:1:5", "--vary", "blue=0.25,0.5"
    run("sweep", script, *vary, "--out", tmp_path / "a.csv", "--pictures", tmp_path / "p")
    rows = table(tmp_path / "a.csv")
    assert [(row["red"], row["blue"]) for row in rows] == [
        (r, b) for r in ("0.0", "0.25", "0.5", "0.75", "1.0") for b in ("0.25", "0.5")
    ]
    assert all(abs(float(row["error"])) < 0.01 and row["nothing"] == "" for row in rows)
    assert float(rows[-1]["rms"]) < 1.0 and len(list((tmp_path / "p").iterdir())) == 10
    # Another script of that name is another sweep: nothing of the first is taken for it.
    script.write_text(SCRIPT.replace("red * red", "red * red * red"))
    code = "from fixedpipe.effects.cli import main; main()"
    command = [sys.executable, "-c", code, "sweep", script, *vary, "--out", tmp_path / "a.csv"]
    subprocess.run(command, check=True, capture_output=True)
    assert [row["error"] for row in table(tmp_path / "a.csv")] != [row["error"] for row in rows]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("K12", "--vary", "red=0:1:3"), "commands takes no|has no parameter 'red'"),
        (("P99",), "There is no figure, study or script 'P99'"),
        (("nowhere.py",), "nowhere.py cannot be read: No such file"),
        (("K12", "--vary", "depth=0:1:3", "--vary", "depth=1"), "--vary names depth twice; give it once"),
        (("K12", "--vary", "depth=0:1:3", "--set", "depth=1"), "--set depth would be ignored"),
        (
            ("K12", "--vary", "depth=0:8:1000000", "--vary", "alpha_x=0.1:1:1000000"),
            "1,000,000,000,000 points",
        ),
        (("K12", "--vary", "depth=0:9:3"), "K12's depth is '9'; give a number from 0 to 8"),
        (("K12", "--vary", "bits=2:8"), "give a whole number from 4 to 16"),
        (("K12", "--machines", "VOODOO"), "There is no machine 'VOODOO'"),
        (("K12", "--machines", "IDEAL", "--vary", "bits=4:8"), "IDEAL is no machine"),
        (("K12", "--machines", "OCTANE"), "K12 cannot be drawn on OCTANE; it can on"),
        (("K12", "--check", "--vary", "depth=0:1:3"), "--check holds for K12's own values"),
        (("K12", "--executor", "cloud:7"), "There is no executor 'cloud:7'.*Give processes"),
        (("K12", "--executor", "processes:0"), "processes:0 does not say how many"),
        (("K12", "--executor", "dask:nowhere"), "dask:nowhere is no scheduler; give dask:local"),
        (("K12", "--executor", "mpi"), "begin the command by mpiexec -n 3"),
        (("K12", "--plot", "a.png"), "--plot shows what varies over one axis or two"),
        (("K12", "--vary", "depth=0:1:3", "--plot", "a.bmp"), "The name a.bmp must end with"),
        (("P11", "--vary", "depth=0:1:3"), "P11 is a study: vary machines and bits alone"),
        (("P11", "--size", "8"), "P11 is a study"),
    ],
)
def test_what_cannot_be_swept_is_said_in_a_sentence(tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert re.search(said, refusal("sweep", *arguments, "--out", tmp_path / "a.csv"))


@pytest.mark.parametrize("name", ["a.txt", "a", "a.csv/"])
def test_tables_have_names(tmp_path, name):
    (tmp_path / "a.csv").mkdir()
    assert refusal("sweep", "K12", "--out", f"{tmp_path}/{name}").startswith("fixedpipe: ")


def test_the_manifest_of_another_figure_is_refused(tmp_path):
    run("sweep", "K12", "--size", "8", "--out", tmp_path / "a.csv")
    said = refusal("sweep", "K02", "--size", "8", "--out", tmp_path / "a.csv")
    assert "is the manifest of a sweep of K12, and this is a sweep of K02; give another" in said


def test_a_point_that_cannot_be_drawn_has_its_reason(tmp_path):
    script = tmp_path / "mine.py"
    script.write_text(SCRIPT.replace("[[red, 0.5, blue]]", "[[1 / red, 0.5, blue]]"))
    done = run("sweep", script, "--vary", "red=0,1", "--out", tmp_path / "a.csv")
    rows = table(tmp_path / "a.csv")
    assert re.search(r"mine\.py, line \d+, raised ZeroDivisionError", rows[0]["refused"])
    assert not rows[0]["sha256"] and rows[1]["sha256"] and "2 points" in done.stdout
    assert done.stdout.rstrip().endswith("1 refused")


def test_a_failure_is_named_and_tried_again(tmp_path, monkeypatch):
    def no_memory(*_, **__):
        raise MemoryError("no room")

    with monkeypatch.context() as patched:
        patched.setattr(points, "digest", no_memory)
        done = run("sweep", "K12", "--size", "8", "--out", tmp_path / "a.csv", status=1)
    assert "1 point failed; the same command tries again:" in done.stderr
    assert "K12 on GEFORCE_256: MemoryError: no room (" in done.stderr
    run("sweep", "K12", "--size", "8", "--out", tmp_path / "a.csv")
    assert json.dumps(table(tmp_path / "a.csv")[0]["failed"]) == '""'


def test_a_second_client_of_a_manifest_is_refused(tmp_path):
    with Manifest(tmp_path / "a.csv.manifest", "a sweep of K12"):
        said = refusal("sweep", "K12", "--size", "8", "--out", tmp_path / "a.csv")
    assert re.search(
        rf"a\.csv\.manifest is in use by the process .+:{os.getpid()}; wait for it, or give", said
    )
