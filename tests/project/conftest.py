"""A wheel of this checkout, and an environment into which it is installed, for tests of what a user gets."""

import os
import site
import subprocess
import sys
import venv
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FOLDERS = ("raster", "pipeline", "effects")


def pip(*arguments):
    """Run pip without a network."""
    command = [sys.executable, "-m", "pip", *arguments, "--quiet", "--no-deps", "--no-index"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel of this checkout, built by the pinned setuptools of this environment."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("wheel")
    # A copy: building leaves build/ and *.egg-info where it is done.
    for name in ("pyproject.toml", "README.md", "LICENSE", *FOLDERS):
        (source / name).symlink_to(ROOT / name)
    pip("wheel", "--no-build-isolation", "--wheel-dir", out, source)
    (path,) = out.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A fresh environment with the wheel, beside this one's NumPy, Numba and the rest: its Python, and where
    its packages lie.
    """
    home = tmp_path_factory.mktemp("environment")
    venv.create(home, with_pip=False)
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    pip("--python", python, "install", wheel)
    # Its own fixedpipe is a hook, which no path brings.
    (place,) = home.glob("**/site-packages")
    (place / "dependencies.pth").write_text("\n".join(site.getsitepackages()))
    return python, place
