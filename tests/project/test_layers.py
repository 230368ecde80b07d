"""The project's rules: which layer may import which, where numbers come from, what a figure must have."""

import ast
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.profiles.profile import EVIDENCE_TAGS, Profile
from fixedpipe.raster import codes, kernel

ROOT = Path(__file__).parents[2]
STANDARD = set(sys.stdlib_module_names)

# What a folder may import besides the standard library; an entry with a dot allows that module alone.
MAY_IMPORT = {
    "raster": {"fixedpipe.raster", "numba", "llvmlite", "numpy"},
    "pipeline": {"fixedpipe.pipeline", "fixedpipe.raster", "numpy"},
    "effects/cli": {
        "fixedpipe.effects",
        "fixedpipe.pipeline",
        "numpy",
        "click",
        "rich",
        "PIL",
        "imageio",
        "matplotlib",
        "trimesh",
        "nrrd",
    },
    "effects/conformance": {"fixedpipe.effects", "fixedpipe.pipeline", "numpy", "PIL"},
    # The ray caster is compiled as kernels are; diagrams have pillow's bitmap font.
    "effects": {
        "fixedpipe.effects",
        "fixedpipe.pipeline",
        "numpy",
        "fixedpipe.raster.kernel",
        "PIL.ImageFont",
    },
    "tests/reference": {
        "tests.reference",
        "fixedpipe.pipeline.enums",
        "fixedpipe.pipeline.state",
        "fixedpipe.pipeline.profiles.profile",
        "fixedpipe.pipeline.profiles",
    },
}
SOURCES = [
    (folder, path)
    for folder in MAY_IMPORT
    for path in sorted((ROOT / folder).rglob("*.py"))
    if not (folder == "effects" and {"cli", "conformance"} & set(path.relative_to(ROOT).parts))
]


def imported_modules(tree):
    """Dotted names of everything a module imports, at its top or inside a function."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute here"
            for alias in node.names:
                yield f"{node.module}.{alias.name}"


def is_allowed(module, allowed):
    return module.split(".")[0] in STANDARD or any(module == a or module.startswith(a + ".") for a in allowed)


@pytest.mark.parametrize(("folder", "path"), SOURCES, ids=lambda p: str(p).removeprefix(f"{ROOT}/"))
def test_a_module_imports_only_what_its_layer_may(folder, path):
    refused = [
        m for m in imported_modules(ast.parse(path.read_text())) if not is_allowed(m, MAY_IMPORT[folder])
    ]
    assert not refused, f"{path.name} must not import {', '.join(refused)}"


def test_the_import_rule_refuses_what_it_should():
    tree = ast.parse(
        "import numpy as np\nfrom fixedpipe.raster.portable import combine\ndef f():\n    import fixedpipe.effects.figures\n"
    )
    refused = [m for m in imported_modules(tree) if not is_allowed(m, MAY_IMPORT["tests/reference"])]
    assert refused == ["numpy", "fixedpipe.raster.portable.combine", "fixedpipe.effects.figures"]


def test_the_reference_runs_without_numpy_numba_or_kernels():
    modules = [
        f"tests.reference.{p.stem}"
        for p in (ROOT / "tests" / "reference").glob("*.py")
        if p.stem != "__init__"
    ]
    code = f"import sys, {', '.join(modules)}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded, package = set(run.stdout.split()), codes.__name__.removesuffix(".codes")
    assert not loaded & {"numpy", "numba"}
    # The enumerations have their values from the list of codes, which imports nothing.
    assert {m for m in loaded if m.startswith(f"{package}.")} == {codes.__name__}


def test_only_one_module_knows_the_compiler():
    compiler = re.compile(r"\b(njit|numba\.jit|@jit|vectorize|guvectorize|cfunc|stencil\()")
    for folder in ("raster", "pipeline", "effects"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            if path != ROOT / "raster" / "kernel.py":
                assert not compiler.search(path.read_text()), f"{path}: use @kernel from raster/kernel.py"


def test_no_kernel_is_made_of_a_source_that_the_name_of_the_cache_leaves_out():
    folder, package = Path(kernel.__file__).parent, kernel.__name__.removesuffix(".kernel")
    imports = {
        path.relative_to(folder): set(imported_modules(ast.parse(path.read_text())))
        for path in folder.rglob("*.py")
    }
    kept = set(kernel.kernel_sources(folder))
    left_out = imports.keys() - kept
    assert left_out
    for path in left_out:
        assert not any(m.startswith(("numba", kernel.__name__)) for m in imports[path]), path
    names = [".".join((package, *path.with_suffix("").parts)) for path in left_out]
    for path in kept:
        assert not any(is_allowed(m, names) for m in imports[path] if m.startswith(package)), path


@pytest.mark.parametrize("name", PROFILES)
def test_every_field_of_a_profile_says_where_its_value_comes_from(name):
    profile = PROFILES[name]
    for field in fields(Profile):
        if field.name not in ("name", "description", "evidence"):
            tag, _, what = profile.evidence[field.name].partition(" ")
            assert tag in EVIDENCE_TAGS, f"{name}.{field.name}"
            assert len(what) > 8, f"{name}.{field.name}: the tag needs a reason"


REFERENCE_FUNCTIONS = [
    (path.stem, node)
    for path in sorted((ROOT / "tests" / "reference").glob("*.py"))
    for node in ast.walk(ast.parse(path.read_text()))
    if isinstance(node, ast.FunctionDef) and node.name != "__init__"
]


@pytest.mark.parametrize(("module", "node"), REFERENCE_FUNCTIONS, ids=lambda x: getattr(x, "name", x))
def test_every_reference_function_names_its_source(module, node):
    text = ast.get_docstring(node) or ""
    assert any(tag in text for tag in EVIDENCE_TAGS), f"{module}.{node.name} needs its source"


def bibliography_keys():
    return set(
        re.findall(r"^@\w+\{([^,\s]+),", (ROOT / "docs" / "bibliography.bib").read_text(), re.MULTILINE)
    )


@pytest.mark.parametrize("figure_id", FIGURES)
def test_every_figure_names_a_paper_of_the_bibliography(figure_id):
    assert FIGURES[figure_id].source in bibliography_keys()


def test_every_figure_has_an_accepted_digest_on_every_machine_and_every_digest_a_figure():
    accepted = {path.stem for path in (ROOT / "tests" / "golden").glob("*.json")}
    assert accepted == {f"{f.id}-{machine}" for f in FIGURES.values() for machine in f.machines}
