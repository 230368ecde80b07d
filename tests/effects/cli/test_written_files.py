"""Files that commands write: missing folders are made, and what cannot be written is refused before anything
is computed. One rule for every command.
"""

import os
import shutil
import stat
import subprocess
import sys

import click
import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import compiling, conformance, golden, main, selftest
from fixedpipe.effects.nv2a_frames.writing import frame_bytes
from fixedpipe.effects.reports import files
from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.traces.writer import TraceWriter
from tests.layers import ROOT

# Commands and what each needs, beside the file or folder that it is to write.
COMMANDS = {
    "figures": ("K12",),
    "passes": ("K12",),
    "parameters": ("F004-4",),
    "print": ("K12",),
    "inspect": ("K12", "--size", "8"),
    "compare": ("K12", "--machines", "GEFORCE_256", "GEFORCE_3", "--size", "8"),
    "animate": ("F004-4", "--vary", "alpha_x=0.1:1:2"),
    "bump": ("heights.png",),
    "roughness": ("heights.png",),
    "material": ("ward",),
    "shadows": ("mesh.obj",),
    "volume": ("sample:engine",),
    "brdf": ("heights.png",),
    "scatter": ("heights.png",),
    "environment": ("heights.png", "--to", "cube"),
    "combiners": ("program.rc",),
    "precision": ("K12",),
    "study": ("P9",),
    "conformance": ("captures",),
    "selftest": (),
    "replay": ("empty.trace",),
    "pixel": ("state.json",),
    "nv2a": ("empty.nv2a",),
    "sweep": ("K12", "--vary", "depth=0:0.4:2"),
}
# What has to be given beside some of their options, and what each file is called.
BESIDE = {
    ("inspect", "--csv"): ("--registers",),
    ("inspect", "--html"): ("--pixel", "1,1"),
    ("inspect", "--json"): ("--pixel", "1,1"),
    ("inspect", "--out"): ("--map", "error"),
    ("inspect", "--plot"): ("--row", "1"),
    ("roughness", "--picture"): ("--out", "good.npz"),
    ("brdf", "--picture"): ("--out", "good.npz"),
    ("brdf", "--resume"): ("--out", "good.npz"),
    ("sweep", "--plot"): ("--out", "good.csv"),
}
ENDINGS = {
    ("roughness", "--out"): "npz",
    ("brdf", "--out"): "npz",
    ("sweep", "--out"): "csv",
    "--json": "json",
    "--csv": "csv",
    "--html": "html",
}
WRITTEN = {
    "--out",
    "--png",
    "--json",
    "--csv",
    "--html",
    "--plot",
    "--picture",
    "--trace",
    "--resume",
    "--junit",
}
PLOTS = {("inspect", "--out"), ("inspect", "--plot"), ("compare", "--out"), ("print", "--out")}


def options():
    """(command, option) of all that write files, golden's aside."""
    context = click.Context(main)
    for name in COMMANDS:
        for parameter in main.get_command(context, name).params:
            if parameter.opts[0] in WRITTEN:
                yield name, parameter.opts[0]


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working folder, with what commands read."""
    monkeypatch.chdir(tmp_path)
    rows = np.add.outer(np.arange(8), 2 * np.arange(16)) * 5
    Image.fromarray(rows.astype(np.uint8)).save("heights.png")
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with TraceWriter("empty.trace") as trace:
        trace.call("glFlush", (), ())
    shutil.copy(ROOT / "docs" / "examples" / "states" / "squared.json", "state.json")
    (tmp_path / "empty.nv2a").write_bytes(frame_bytes((Clear(label="black", color=(0, 0, 0, 0)),), 8, 8, 24))
    (tmp_path / "program.rc").write_text("!!RC1.0 out.rgb = col0; out.a = col0.a;")
    (tmp_path / "captures" / "Suite").mkdir(parents=True)
    Image.new("RGBA", (640, 480)).save("captures/Suite/case.png")
    return tmp_path


def test_every_command_with_such_options_is_known():
    context = click.Context(main)
    known = {name for name in main.list_commands(context) if name != "golden"}
    writing = {
        name
        for name in known
        if WRITTEN & {option for p in main.get_command(context, name).params for option in p.opts}
    }
    assert writing == COMMANDS.keys()


def refuse_to_compute(*_):
    raise AssertionError("it began to compute")


@pytest.mark.parametrize(("name", "option"), list(options()), ids=lambda word: word.strip("-"))
def test_what_cannot_be_written_is_refused_before_anything_is_computed(folder, monkeypatch, name, option):
    if (name, option) in PLOTS:
        pytest.importorskip("matplotlib")
    for module in (compiling, conformance, selftest):
        monkeypatch.setattr(module, "announce_compiling", refuse_to_compute, raising=False)
    ending = ENDINGS.get((name, option)) or ENDINGS.get(option, "png")
    beside = BESIDE.get((name, option), ())
    done = run(name, *COMMANDS[name], option, f"heights.png/folder/file.{ending}", *beside)
    assert done.exit_code == 2, (done.output, done.exception)
    assert "heights.png" in done.stderr and "cannot be written to" in done.stderr, done.stderr


@pytest.mark.parametrize("option", ["--json", "--junit"])
def test_golden_check_refuses_such_a_file_before_it_runs_pytest(folder, monkeypatch, option):
    monkeypatch.setattr(golden, "_run_pytest", refuse_to_compute)
    done = run("golden", "check", option, "heights.png/folder/file")
    assert done.exit_code == 2 and "cannot be written to" in done.stderr, (done.output, done.exception)


def test_a_file_in_the_place_of_a_folder_is_named(folder):
    done = run("parameters", "F004-4", "--json", "heights.png/x.json")
    assert "heights.png is a file, and no folder" in done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("inspect", "K12", "--size", "8", "--pixel", "3,3", "--html"),
        ("inspect", "K12", "--size", "8", "--registers", "--csv"),
        ("precision", "K12", "--size", "8", "--bits", "8", "--json"),
        ("combiners", "program.rc", "--json"),
        ("parameters", "F004-4", "--json"),
    ],
)
def test_missing_folders_are_made(folder, arguments):
    done = run(*arguments, "new/folders/file")
    assert done.exit_code == 0, (done.output, done.exception)
    assert [path.name for path in (folder / "new" / "folders").iterdir()] == ["file"]


def test_a_device_is_written_to_and_not_replaced(folder):
    assert run("parameters", "F004-4", "--json", os.devnull).exit_code == 0
    assert stat.S_ISCHR(os.stat(os.devnull).st_mode)


def test_a_pipe_is_written_to_and_not_replaced(folder):
    code = (
        "import fixedpipe.effects.reports.files as f; f.write_whole(f.writable_file('/dev/stdout'), b'all')"
    )
    command = [sys.executable, "-c", code]
    assert subprocess.run(command, capture_output=True, check=True).stdout == b"all"
    with open("kept", "wb") as kept:
        kept.write(b"before, ")
        kept.flush()
        subprocess.run(command, stdout=kept, check=True)
    assert (folder / "kept").read_bytes() == b"before, all"
    os.mkfifo("pipe")
    reader = subprocess.Popen(["cat", "pipe"], stdout=subprocess.PIPE)
    files.write_whole(files.writable_file("pipe"), b"all of it")
    assert reader.communicate()[0] == b"all of it"
    assert stat.S_ISFIFO(os.stat("pipe").st_mode)
