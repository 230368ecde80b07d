"""``make matrix``: the self-test and a few figures' digests under every Python, with the oldest and with the
newest packages that pyproject.toml allows.

Each run has an environment and a cache of kernels of its own, in a temporary folder, one after the other. A
Python that is not here is said and is no failure; ``--download`` lets uv look for it.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
# Of the packages that the project names itself, by uv's words: the lowest versions allowed, or the highest.
RESOLUTIONS = {"oldest": "lowest-direct", "newest": "highest"}
# Of bump maps, materials, shadow maps on a machine of twelve bits, and texture shaders.
FIGURES = (
    "F004-2-GEFORCE_256",
    "F004-4-GEFORCE_256",
    "F003-21-INFINITE_REALITY",
    "F001-1-GEFORCE_3",
)
TESTS = [f"tests/golden/test_golden.py::test_a_figure_keeps_its_accepted_bits[{name}]" for name in FIGURES]
# Warnings of other versions than the pinned ones are not what is asked here.
PYTEST = ["-p", "no:xdist", "-p", "no:cacheprovider", "-o", "filterwarnings=", "-q"]
_LAST = 300  # characters of what a command that failed said


@dataclass(frozen=True)
class Run:
    """What came of a Python with some packages. ``failed``: whether it counts as a failure."""

    python: str
    packages: str
    versions: str
    selftest: str
    figures: str
    failed: bool = False

    @property
    def row(self):
        """As the table has it."""
        return self.python, self.packages, self.versions, self.selftest, self.figures


HEAD = ("Python", "packages", "versions", "self-test", "figures")


def uv():
    """The command that makes environments: beside this Python, or on the path."""
    beside = Path(sys.executable).with_name("uv")
    return str(beside) if beside.is_file() else "uv"


def call(*command, environment=None):
    """A finished process; its output is text."""
    variables = {name: value for name, value in os.environ.items() if name != "VIRTUAL_ENV"}
    variables["PATH"] = os.pathsep.join([*pyenv_folders(), variables.get("PATH", "")])
    return subprocess.run(
        command, cwd=ROOT, env=variables | (environment or {}), capture_output=True, text=True, check=False
    )


def pyenv_folders():
    """Where pyenv keeps Pythons: its commands on the path run the chosen one alone, and fail for others."""
    root = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    return [str(path) for path in sorted(root.glob("versions/*/bin"))]


def last_words(process):
    """The end of what a process said."""
    return " ".join((process.stdout + process.stderr).split())[-_LAST:]


def found_python(python, download):
    """The path of a Python, or None."""
    policy = () if download else ("--no-python-downloads",)
    if download:
        call(uv(), "python", "install", python)
    process = call(uv(), "python", "find", "--system", *policy, python)
    return process.stdout.strip() if process.returncode == 0 else None


def installed(python, resolution, folder):
    """(the environment's Python, None), or (None, why there is none)."""
    home = Path(folder) / "environment"
    inside = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    wheels = "--only-binary", ":all:", "--no-binary", "fixedpipe"
    install = uv(), "pip", "install", "--quiet", "--python", str(inside), *wheels
    steps = (
        (uv(), "venv", "--quiet", "--python", python, str(home)),
        (*install, "--resolution", RESOLUTIONS[resolution], "--editable", "."),
        (*install, "pytest>=8", "hypothesis>=6.100"),
    )
    for step in steps:
        process = call(*step)
        if process.returncode:
            return None, last_words(process)
    return inside, None


def run_of(python, found, packages, arguments):
    """The Run of one Python, where it was found, with some packages."""
    with tempfile.TemporaryDirectory(prefix="fixedpipe-matrix-") as folder:
        inside, why = installed(found, packages, folder)
        if inside is None:
            return Run(python, packages, "", f"not installed: {why}", "", failed=True)
        kept = {"NUMBA_CACHE_DIR": str(Path(folder) / "kernels"), "PYTHONPATH": ""}
        written = Path(folder) / "selftest.json"
        command = (inside, "-m", "fixedpipe.effects.cli", "selftest", "--json", written, *arguments)
        selftest = call(*map(str, command), environment=kept)
        sys.stderr.write(selftest.stdout + selftest.stderr)
        if not written.is_file():
            return Run(python, packages, "", f"ended: {last_words(selftest)}", "", failed=True)
        found = json.loads(written.read_text())
        versions = ", ".join(f"{name} {found['versions'][name]}" for name in ("python", "numba", "numpy"))
        drawn = sum(check["frames"] for check in found["checks"])
        failures = sum(len(check["failures"]) for check in found["checks"])
        figures = call(str(inside), "-m", "pytest", *PYTEST, *TESTS, environment=kept)
        if figures.returncode:
            sys.stderr.write(figures.stdout + figures.stderr)
        return Run(
            python,
            packages,
            versions,
            f"{failures} of {drawn} differ" if failures else f"all {drawn} equal",
            f"{len(TESTS)} equal" if figures.returncode == 0 else f"not equal: {last_words(figures)}",
            failed=bool(failures or selftest.returncode or figures.returncode),
        )


def as_table(runs):
    """The runs as lines of Markdown."""
    rows = [HEAD, ("---",) * len(HEAD), *(run.row for run in runs)]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def main(arguments=None):
    parser = argparse.ArgumentParser(description="The self-test under every Python and range of packages.")
    parser.add_argument("--python", action="append", choices=PYTHONS, help="this one alone; may be repeated")
    parser.add_argument("--packages", action="append", choices=tuple(RESOLUTIONS), help="likewise")
    parser.add_argument("--download", action="store_true", help="let uv download a Python that is not here")
    parser.add_argument("--cpus", action="store_true", help="compile for other processors too, in each")
    options = parser.parse_args(arguments)
    lowest = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["requires-python"]
    runs = []
    for python in options.python or PYTHONS:
        found = found_python(python, options.download)
        for packages in options.packages or tuple(RESOLUTIONS):
            if found is None:
                runs.append(Run(python, packages, "", "left out: no such Python here", ""))
            else:
                runs.append(run_of(python, found, packages, ("--cpus",) * options.cpus))
            print(" | ".join(runs[-1].row), flush=True)
    print(f"\nfixedpipe asks for Python {lowest}.\n\n{as_table(runs)}", end="")
    return int(any(run.failed for run in runs) or all(not run.versions for run in runs))


if __name__ == "__main__":
    sys.exit(main())
