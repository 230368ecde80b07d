"""What a user installs: a wheel that claims one name, fixedpipe, and works beside folders that have ours."""

import doctest
import os
import re
import subprocess
import sys
import tomllib
import zipfile

import pytest

from tests.project.conftest import FOLDERS, ROOT


def packages():
    """Dotted names of the folders that hold modules."""
    return {
        ".".join(("fixedpipe", *path.parent.relative_to(ROOT).parts))
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("__init__.py")
    }


def test_every_package_is_listed_and_every_module_lies_in_one():
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    assert set(listed) == packages()
    assert listed == sorted(listed)
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*.py"):
            assert (path.parent / "__init__.py").exists(), path


def test_the_wheel_holds_fixedpipe_alone_and_all_of_it(wheel):
    names = [name for name in zipfile.ZipFile(wheel).namelist() if not name.endswith("/")]
    assert {name.split("/")[0].split("-")[0] for name in names} == {"fixedpipe"}
    files = {name.removeprefix("fixedpipe/") for name in names if name.startswith("fixedpipe/")}
    ours = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.is_file()]
    assert files == {
        path.relative_to(ROOT).as_posix()
        for path in ours
        if path.suffix in (".py", ".pyi", ".typed", ".bib", ".js", ".css", ".json", ".toml", ".h", ".glsl")
        or path.name == "LICENSE"
    }
    assert {name for name in files if name.endswith("py.typed")} == {
        f"{folder}/py.typed" for folder in FOLDERS
    }


@pytest.fixture(scope="module")
def beside_folders_of_ours(installed, tmp_path_factory):
    """A project's folder with packages of our names: run(code)."""
    python, place = installed
    project = tmp_path_factory.mktemp("project")
    for folder in FOLDERS:
        (project / folder).mkdir()
        (project / folder / "__init__.py").write_text('raise RuntimeError("not ours")\n')
    kept = {
        k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "COV_", "PYTEST", "NUMBA_CACHE"))
    }

    def run(*arguments):
        # Kernels are kept in the environment, as a user's are.
        found = subprocess.run(
            [python, *arguments], cwd=project, env=kept, capture_output=True, text=True, check=False
        )
        assert found.returncode == 0, found.stderr
        return found.stdout

    return run, place


def test_it_is_found_beside_folders_of_our_names_and_is_the_wheel_s(beside_folders_of_ours):
    run, place = beside_folders_of_ours
    for name in ("fixedpipe.raster.codes", "fixedpipe.pipeline", "fixedpipe.effects.figures"):
        assert run("-c", f"import {name} as found; print(found.__file__)").startswith(str(place))
    names = "Clear, Draw, Mesh, PassState, GEFORCE_256, validate"
    loaded = run("-c", f"import sys\nfrom fixedpipe.pipeline import {names}\nprint(*sys.modules)").split()
    assert "fixedpipe.raster.codes" in loaded
    assert not {"numba", "fixedpipe.raster.kernel"} & set(loaded)


def test_the_command_line_answers(beside_folders_of_ours):
    run, place = beside_folders_of_ours
    assert "F004-4" in run("-m", "fixedpipe.effects.cli", "figures", "--list")
    assert (
        run(place.parents[2] / "bin" / "fixedpipe", "--version").startswith("fixedpipe ") or os.name == "nt"
    )


def test_kernels_are_kept_outside_the_package_which_pip_removes_whole(beside_folders_of_ours):
    run, place = beside_folders_of_ours
    prefix = place.parents[2] if os.name != "nt" else place.parents[1]
    folder = run("-c", "from fixedpipe.raster.kernel import CACHE_FOLDER; print(CACHE_FOLDER)").strip()
    assert folder.startswith(str(prefix / "var" / "cache" / "fixedpipe" / "kernels"))
    assert not [path for path in (place / "fixedpipe").rglob(".*")]


def test_the_page_names_each_extra():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    rows = re.findall(r"^\| `(\w+)` \|", (ROOT / "docs" / "install.md").read_text(), re.MULTILINE)
    assert rows == list(extras)


@pytest.mark.slow
@pytest.mark.parametrize(("page", "fewest"), [("README.md", 5), ("docs/from-python.md", 10)])
def test_a_page_s_examples_run_there(beside_folders_of_ours, page, fewest):
    run, _ = beside_folders_of_ours
    examples = doctest.DocTestParser().get_examples((ROOT / page).read_text())
    assert len(examples) >= fewest
    assert any(re.search(r"\bexecute\(", example.source) for example in examples)
    code = (
        "import doctest, sys\n"
        f"results = doctest.testfile({str(ROOT / page)!r}, module_relative=False)\n"
        "sys.exit(results.failed)"
    )
    run("-c", code)


# A user's effect, as an editor reads it, and mistakes in it with what is said of them.
EFFECT = """\
import numpy as np

from fixedpipe.pipeline import (
    GEFORCE_256, Blending, Clear, Command, Draw, Mesh, PassState, Sampler, TexImage, TextureUnit,
    describe, execute, execute_ideal, parse_program, texture_2d, validate,
)
from fixedpipe.pipeline.enums import BlendFactor, TextureFilter


def one_pass(corners: list[list[float]], size: int) -> tuple[Command, ...]:
    grey = texture_2d(np.full((2, 2, 4), 128, np.uint8))
    unit = TextureUnit("grey", Sampler(min_filter=TextureFilter.NEAREST))
    state = PassState(
        texture_units=(unit,),
        blending=Blending(source=BlendFactor.ONE, destination=BlendFactor.ONE),
        register_combiners=parse_program("!!RC1.0 {rgb {spare0 = tex0;}} out.rgb = spare0;").combiners,
    )
    mesh = Mesh(corners, colors=np.ones((3, 3)), texture_coordinates=(np.zeros((3, 2)),))
    return (
        Clear(label="black", color=(0, 0, 0, 0)),
        TexImage(label="grey texels", texture="grey", image=grey),
        Draw(label="colour times texel", mesh=mesh, state=state),
    )


frame = one_pass([[-1, -1], [3, -1], [-1, 3]], 4)
validate(frame, GEFORCE_256, 4, 4)
result = execute(frame, GEFORCE_256, 4, 4, engine="portable", record=True)
difference = execute_ideal(frame, 4, 4, guide=result).image() - result.framebuffer.color
reveal_type(execute)
reveal_type(result.image())
reveal_type(frame[0].label)
print(describe(frame), difference.max(), result.records[0].x)
"""
MISTAKES = {
    ("execute(frame, GEFORCE_256, 4, 4,", 'execute(frame, "GEFORCE_256", 4, 4,'): '"str"; expected "Profile"',
    ('engine="portable"', 'engine="fast"'): """expected "Literal['portable', 'columns'] | None\"""",
    ("BlendFactor.ONE, d", "TextureFilter.LINEAR, d"): '"TextureFilter"; expected "BlendFactor"',
    ("color=(0, 0, 0, 0)", "color=(0, 0, 0)"): 'expected "tuple[float, float, float, float] | None"',
    ("(frame, GEFORCE_256, 4, 4)", "(frame[0], GEFORCE_256, 4, 4)"): 'expected "Iterable[Clear | Draw |',
    ("Blending, Clear", "Blendings, Clear"): 'has no attribute "Blendings"',
    ("result.framebuffer.color", "result.frame_buffer.color"): 'has no attribute "frame_buffer"',
    ("Mesh(corners, ", "Mesh(corners, color=None, "): 'Unexpected keyword argument "color"',
}


@pytest.mark.slow
def test_an_editor_knows_the_door_s_types_and_says_what_is_wrong(beside_folders_of_ours, tmp_path):
    _, place = beside_folders_of_ours
    python = place.parents[2] / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    command = [sys.executable, "-m", "mypy", "--strict", "--python-executable", python]

    def said(source):
        # A name of its own: mypy takes a file of the same size and second for the one that it looked at.
        path = tmp_path / f"effect_{len(list(tmp_path.glob('*.py')))}.py"
        path.write_text(source)
        done = subprocess.run(
            [*command, path.name], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        return done.returncode, done.stdout + done.stderr

    status, text = said(EFFECT)
    assert status == 0, text
    shown = re.findall(r'Revealed type is "(.*)"', text)
    assert re.match(
        r"def \(commands: .*\[.*Clear \| .*\], profile: .*Profile, width: .*int, .*Result$", shown[0]
    )
    assert "ndarray" in shown[1] and "unsignedinteger" in shown[1]
    assert "str" in shown[2]
    for (right, wrong), sentence in MISTAKES.items():
        assert EFFECT.count(right) == 1, right
        status, text = said(EFFECT.replace(right, wrong))
        assert status == 1
        assert sentence in text, wrong
