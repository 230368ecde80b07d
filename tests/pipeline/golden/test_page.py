"""docs/golden-images.md: its files are written, its commands are run, and they print what it says."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from fixedpipe.pipeline.golden.store import FORMAT
from fixedpipe.pipeline.native.background_compiling import make_ready

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "golden-images.md"
_BLOCK = re.compile(r"^```(\w+)(?: ([\w./]+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_ANY = "…"  # a line that stands for any others
_COMPILING = re.compile(r"(?i)compiling kernel|done\. kernels")  # said once, on a new computer
# What a reader's shell lacks: where CI or BUILD_NUMBER is set, pytest prints a summary's lines whole.
_NOT_A_READER_S = ("PYTEST", "COV_", "FORCE_COLOR", "CI", "BUILD_NUMBER")
_TIME = re.compile(r"\bin \d+\.\d\ds\b")


def blocks():
    """(language, file's path or "", text) of every block of the page."""
    return [(kind, path, text) for kind, path, text in _BLOCK.findall(PAGE.read_text())]


def commands():
    """(command, what the page says that it prints, as lines) of every console block, in order."""
    for kind, _, text in blocks():
        if kind == "console":
            for part in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                command, *printed = part.splitlines()
                yield command, printed


def write_files(folder, *beginnings):
    """Write the page's files whose paths begin so."""
    for _, path, text in blocks():
        if path.startswith(beginnings):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(text)


def run(command, folder):
    """What a shell's command prints, as lines, with every time of a run the same."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(_NOT_A_READER_S)}
    kept |= {
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), kept["PATH"]]),
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTEST_ADDOPTS": "-p no:cacheprovider -p no:hypothesispytest -p no:xdist -p no:syrupy",
        "COLUMNS": "80",
    }
    done = subprocess.run(
        command,
        shell=True,
        cwd=folder,
        env=kept,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    lines = _TIME.sub("in 0.10s", done.stdout).splitlines()
    return [line for line in lines if not _COMPILING.match(line)]


def fits(said, printed):
    """Whether lines are those that the page says, where a line of its own stands for any."""
    pattern = "\n".join("(?s:.*)" if line == _ANY else re.escape(line) for line in said)
    return re.fullmatch(pattern, "\n".join(printed)) is not None


@pytest.mark.skipif(os.name == "nt", reason="the page's commands are a POSIX shell's")
def test_every_command_of_the_page_prints_what_it_says(tmp_path):
    for engine in ("portable", "vector"):  # or a line that they are being compiled stands among the dots
        make_ready(engine)
    write_files(tmp_path, "disc.py", "pytest.ini", "tests/test_disc.py")
    later = ("tests/", "against/", "gpu/", "others/test_golden.py")
    ran = 0
    for command, said in commands():
        if command.startswith("fixedpipe golden record"):  # the other tests come in here
            disc = (tmp_path / "tests" / "test_disc.py").read_text()
            write_files(tmp_path, *later)
            (tmp_path / "tests" / "test_disc.py").write_text(disc)
        printed = run(command, tmp_path)
        assert fits(said, printed), "\n".join([f"$ {command}", *printed])
        ran += 1
    assert ran >= 20


def test_what_a_job_runs_stands_on_the_page_as_a_command():
    known = {command for command, _ in commands()}
    jobs = [text for kind, _, text in blocks() if kind == "yaml"]
    asked = [command for text in jobs for command in re.findall(r"^- run: (.*)$", text, re.MULTILINE)]
    assert len(asked) == 2
    assert set(asked) <= known


def test_every_block_is_a_file_that_is_written_or_commands_that_are_run():
    for kind, path, text in blocks():
        assert kind in ("console", "yaml") or path, text
    assert PAGE.read_text().count("```") == 2 * len(blocks())


def test_the_page_has_the_store_s_format():
    assert f"| `format` | {FORMAT}; another one is refused |" in PAGE.read_text()


# The change of each row of the page's table, as lines of disc.py; None packs the accepted file anew.
CHANGES = {
    "one pixel, by one grey step": "picture[32, 32] -= 1",
    "one pixel black": "picture[32, 32] = 0",
    "four pixels black": "picture[32:34, 32:34] = 0",
    "a row black": "picture[32] = 0",
    "one row down": "picture = np.roll(picture, 1, axis=0)",
    "a column more": "picture = np.pad(picture, ((0, 0), (0, 1)))",
    "the file packed anew": None,
}
# Module of the page's, what records its picture, what a comparison asks for; in the table's order.
OTHERS = {
    "test_mpl": ("--mpl-generate-path=others/baseline", "--mpl"),
    "test_regressions": ("--force-regen", ""),
    "test_syrupy": ("--snapshot-update", ""),
    "test_syrupy_by_pixels": ("--snapshot-update", ""),
    "test_golden": ("--golden-record", ""),
}


@pytest.mark.slow  # a process for each of forty comparisons
@pytest.mark.parametrize("column", range(len(OTHERS)), ids=list(OTHERS))
def test_other_plug_ins_see_what_the_table_says(tmp_path, column):
    module, (record, compare) = list(OTHERS.items())[column]
    for package in {"test_mpl": ["pytest_mpl"], "test_regressions": ["pytest_regressions"]}.get(module, []):
        pytest.importorskip(package, reason=f"{package} is not installed")
    if "syrupy" in module:
        pytest.importorskip("syrupy", reason="syrupy is not installed")
    write_files(tmp_path, "disc.py", "pytest.ini", f"others/{module}.py")
    text = (tmp_path / "disc.py").read_text()

    def passes(*arguments):
        command = [sys.executable, "-B", "-m", "pytest", "-p", "no:cacheprovider", f"others/{module}.py"]
        command += [argument for argument in arguments if argument]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0

    passes(record)
    assert passes(compare)
    table = re.findall(r"^\| (.+?) \| " + r"(passes|fails) \| ?" * 5 + "$", PAGE.read_text(), re.MULTILINE)
    assert [row[0] for row in table] == list(CHANGES)
    for what, *said in table:
        changed = text
        if CHANGES[what] is None:
            for path in tmp_path.rglob("*.png"):
                image = Image.open(path)
                image.load()
                image.save(path, compress_level=0)
        else:
            changed = f"{text.replace('return', 'picture =')}    {CHANGES[what]}\n    return picture\n"
        (tmp_path / "disc.py").write_text(changed)
        assert passes(compare) == (said[column] == "passes"), what
