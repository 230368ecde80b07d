"""The project's rules: which package may import which, where numbers come from, what a figure must have."""

import ast
import re
import subprocess
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.technique import OWN
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.profiles.known import EVIDENCE_TAGS
from fixedpipe.raster import codes, kernel
from tests import layers

ROOT = Path(__file__).parents[2]
STANDARD = set(sys.stdlib_module_names)
LAYERS = ("raster", "pipeline", "effects")
SOURCES = [path for layer in LAYERS for path in sorted((ROOT / layer).rglob("*.py"))]
REFERENCE = sorted((ROOT / "tests" / "reference").glob("*.py"))
MODULES = {
    ".".join(("fixedpipe", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__"): path
    for path in SOURCES
}


def package_of(path):
    """The package of tests/layers.py that a file below a layer belongs to."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return "/".join(parts[:2]).removesuffix("/__init__")


def imported_modules(tree):
    """Dotted names of everything a module imports, at its top or inside a function; not what it imports
    ``if TYPE_CHECKING``, for annotations alone.
    """
    only_types = {
        inner
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if node in only_types:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute here"
            for alias in node.names:
                yield f"{node.module}.{alias.name}"


def imports_of(path, tree):
    """What a module imports from outside its package: packages of ours, and libraries."""
    found = set()
    for name in imported_modules(tree):
        first = name.split(".")[0]
        if first != "fixedpipe":
            found.add(first)
            continue
        module = name if name in MODULES else name.rpartition(".")[0]
        found.add(package_of(MODULES[module]))
    return found - STANDARD - {package_of(path)}


@cache
def imports():
    """What each package imports from outside itself. Tests ask; collection waits for none."""
    found = defaultdict(set)
    for path in SOURCES:
        found[package_of(path)] |= imports_of(path, ast.parse(path.read_text()))
    return dict(found)


def test_every_package_is_in_the_table_and_imports_what_stands_above_it():
    assert layers.PACKAGES.keys() | set(LAYERS) == imports().keys()
    above = []
    for package in layers.PACKAGES:
        assert set(layers.imports_of(package)) <= set(above), package
        above.append(package)


@pytest.mark.parametrize("package", layers.PACKAGES)
def test_a_package_imports_what_the_table_says(package):
    listed = {*layers.imports_of(package), *layers.LIBRARIES.get(package, ())}
    assert imports()[package] - {"numpy"} == listed


@pytest.mark.parametrize("layer", LAYERS)
def test_a_door_imports_nothing_before_it_is_asked(layer):
    assert not imports()[layer]


def test_the_rule_sees_imports_inside_functions_and_through_a_package():
    tree = ast.parse(
        "import math\nimport numpy as np\nfrom fixedpipe.raster.portable import combine\n"
        "def f():\n    from fixedpipe.pipeline import execute\n    import click\n"
    )
    path = ROOT / "raster" / "columns" / "combine.py"
    assert imports_of(path, tree) == {"numpy", "raster/portable", "pipeline", "click"}
    # Each of which the table refuses.
    allowed = {*layers.imports_of("raster/columns"), *layers.LIBRARIES.get("raster/columns", ()), "numpy"}
    assert imports_of(path, tree) - allowed == {"raster/portable", "pipeline", "click"}


def test_the_page_shows_the_table():
    page = layers.PAGE.read_text()
    assert layers.with_table(page) == page, "run `make layers`"


# Who is what, in words that the table must keep.
NEVER = {
    "what a program is knows no validation": ("pipeline/programs", {"pipeline/validation"}),
    "notations know no validation": ("pipeline/notations", {"pipeline/validation"}),
    "validation asks no engine": (
        "pipeline/validation",
        {"pipeline/native", "pipeline/columns", "pipeline/execution", "pipeline/ideal", "raster/"},
    ),
    "nor what an engine leaves": (
        "pipeline/validation",
        {"pipeline/framebuffers"},
    ),
    "the readable engine does not know the fast one": ("raster/portable", {"raster/vector"}),
    "the column engine's arithmetic is not compiled": ("raster/columns", {"raster/kernel", "numba"}),
    "whole images are not compiled": ("raster/pixels", {"raster/kernel", "numba"}),
    "the ideal runs on no machine": ("pipeline/ideal", {"pipeline/execution"}),
    "reports need no command line": ("effects/reports", {"effects/cli", "click", "rich"}),
    "scenes light nothing": ("effects/scenes", {"effects/shadows", "effects/acceptance"}),
}


@pytest.mark.parametrize("rule", NEVER)
def test_some_things_are_never_known(rule):
    package, never = NEVER[rule]
    libraries = {name for names in layers.LIBRARIES.values() for name in names}
    assert never <= {*layers.PACKAGES, *libraries, "raster/"}
    imported = imports()[package]
    assert not [name for name in imported for other in never if name == other or other == name[: len(other)]]


def test_the_command_line_s_library_is_the_command_line_s():
    assert [package for package, libraries in imports().items() if {"click", "rich"} & libraries] == [
        "effects/cli"
    ]


# Code that uses a folder's name as a module's, at a string's beginning or at a line's.
BARE_NAME = re.compile(
    r"(?m)(^|;)\s*(from|import) (raster|pipeline|effects)\b(?! of| that)|\A(raster|pipeline|effects)\.\w+"
)
# What a file has that uses one, or may: its text is searched first, which takes a tenth of parsing it.
MAYBE_BARE = re.compile(
    r"\b(from|import)\b[^#\n]*(?<!\.)\b(raster|pipeline|effects)\b|[\"'](raster|pipeline|effects)\.\w"
)


@pytest.mark.parametrize("folder", [*LAYERS, "tests", "bench"])
def test_nobody_uses_the_folders_names_as_modules(folder):
    # From the checkout's root `raster.codes` could be imported, as a second copy of fixedpipe.raster.codes.
    # A stranger's folders may have our names: his tests run where no checkout is.
    others = {Path(__file__), *(ROOT / "tests" / "stranger").rglob("*.py")}
    for path in sorted({*(ROOT / folder).rglob("*.py")} - others):
        if not MAYBE_BARE.search(source := path.read_text()):
            continue
        tree = ast.parse(source)
        assert not [m for m in imported_modules(tree) if m.split(".")[0] in LAYERS], path
        texts = [n.value for n in ast.walk(tree) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
        assert not [text for text in texts if BARE_NAME.search(text)], path


@pytest.mark.parametrize(
    "text", ["raster.codes.X", "import x\nfrom raster import codes", "x; import effects"]
)
def test_code_in_a_string_is_seen(text):
    assert BARE_NAME.search(text)
    assert MAYBE_BARE.search(f'"{text}"')


# The command line's subcommands, every module with kernels, figures and studies, suites, and the names at the
# pipeline's door.
FINDERS = {
    "effects/cli/__init__.py",
    "effects/cli/warmup.py",
    "effects/collection.py",
    "effects/conformance/redraw.py",
    "effects/figures/figure.py",
    "pipeline/__init__.py",
}


def test_modules_are_found_by_name_in_these_places_alone():
    found = {path for path in SOURCES if re.search(r"import_module|__import__", path.read_text())}
    assert {path.relative_to(ROOT).as_posix() for path in found} == FINDERS


def test_nobody_asks_which_machine_it_is():
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Compare):
                compared = [n for n in (node.left, *node.comparators) if isinstance(n, ast.Name)]
                assert not [n for n in compared if n.id in PROFILES], f"{path}:{node.lineno}: ask for a field"


# What register combiners are made of, and who makes it in effects: the words of techniques, and suites, which
# transcribe the fields that a capture's program set.
COMBINERS = {
    *("RGBPortion", "AlphaPortion", "CombinerInput"),
    *("CombinerLookup", "GeneralCombiner", "FinalCombiner"),
}
MAKERS = {"effects/passes", "effects/conformance"}


def combiners_made(tree):
    """Lines on which code makes a part of register combiners."""
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    called = [(node.lineno, getattr(node.func, "id", getattr(node.func, "attr", ""))) for node in calls]
    return [line for line, name in called if name in COMBINERS]


def test_techniques_say_combiners_in_words():
    made = {}
    for path in sorted((ROOT / "effects").rglob("*.py")):
        if lines := combiners_made(ast.parse(path.read_text())):
            made.setdefault(package_of(path), []).append((path.name, lines))
    assert made.keys() == MAKERS, "use the words of effects/passes/combiners.py"
    assert [name for name, _ in made["effects/passes"]] == ["combiners.py"]


def test_a_portion_that_is_made_by_hand_is_seen():
    tree = ast.parse(
        "a = RGBPortion(b)\nfrom x import state\nc = [state.FinalCombiner()]\nisinstance(a, RGBPortion)"
    )
    assert combiners_made(tree) == [1, 3]


# The stages of a fragment, and why an engine has no file of that name.
STAGES = ("interpolate", "sample", "unit", "texture_shader", "combine", "per_fragment")
WITHOUT = {
    "raster/portable": {},
    "raster/vector": {"texture_shader": "the vector engine's stages are paths of a unit"},
    "raster/columns": {"unit": "pipeline/columns/textures.py reads a unit's state"},
    "pipeline/ideal": {
        "interpolate": "weights, which are not interpolated but computed: weights.py",
        "texture_shader": "the column engine's stages, in real numbers: shade.py",
        "unit": "sample.py reads a unit's state",
    },
    "tests/reference": {"unit": "sample.py reads a unit's state"},
}


@pytest.mark.parametrize("engine", WITHOUT)
def test_a_stage_has_the_same_name_in_every_engine(engine):
    there = {path.stem for path in (ROOT / engine).glob("*.py")}
    assert set(STAGES) - there == WITHOUT[engine].keys()


# Modules that are read as a whole, and longer than others may be.
LONG = {
    "pipeline/state.py": "the vocabulary",
    "pipeline/enums.py": "the vocabulary",
    "pipeline/opengl/tokens.py": "OpenGL's numbers, a line each",
    "raster/vector/lanes.py": "the instructions of explicit vectors, a function each",
}


def test_modules_are_short_enough_to_be_read():
    lines = {path.relative_to(ROOT).as_posix(): len(path.read_text().splitlines()) for path in SOURCES}
    assert {name for name, count in lines.items() if count > 600} == LONG.keys()


def public_functions(path):
    """The functions of a module, or of a class in it, that others may call, but for OpenGL's entry points:
    their parameters are the specification's.
    """
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            decorators = [ast.unparse(decorator) for decorator in node.decorator_list]
            if not any(decorator.startswith("entry(") for decorator in decorators):
                yield node


@pytest.mark.parametrize("layer", ["pipeline", "effects"])
def test_public_functions_take_few_arguments_by_position(layer):
    # Kernels take what a loop reads, and a subcommand its options.
    for path in sorted((ROOT / layer).rglob("*.py")):
        if package_of(path) == "effects/cli":
            continue
        for function in public_functions(path):
            taken = len(function.args.posonlyargs) + len(function.args.args)
            assert taken <= 8, f"{path}: {function.name} takes {taken}"


def test_the_reference_runs_without_numpy_numba_or_kernels():
    modules = [
        f"tests.reference.{p.stem}"
        for p in (ROOT / "tests" / "reference").glob("*.py")
        if p.stem != "__init__"
    ]
    assert len(modules) > 20
    code = f"import sys, {', '.join(modules)}; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = set(run.stdout.split())
    assert not loaded & {"numpy", "numba"}
    # The enumerations have their values from the list of codes, which imports nothing.
    package = kernel.__name__.removesuffix(".kernel")
    assert {m for m in loaded if m.startswith(f"{package}.")} == {codes.__name__}


REFERENCE_IMPORTS = {
    "tests.reference",
    "fixedpipe.pipeline.enums",
    "fixedpipe.pipeline.state",
    "fixedpipe.pipeline.profiles",
}


@pytest.mark.parametrize("path", REFERENCE, ids=lambda path: path.stem)
def test_the_reference_imports_the_vocabulary_alone(path):
    for name in imported_modules(ast.parse(path.read_text())):
        known = any(name == allowed or name.startswith(f"{allowed}.") for allowed in REFERENCE_IMPORTS)
        assert known or name.split(".")[0] in STANDARD, name


def test_only_one_module_knows_the_compiler():
    compiler = re.compile(
        r"\b(njit|numba\.jit|vectorize|guvectorize|cfunc)\b|@jit\b|import .*\bjit\b|\bstencil\("
    )
    for line in ("@jit(nopython=True)", "from numba import int64, jit", "numba.njit(f)", "@stencil()"):
        assert compiler.search(line), line
    for path in SOURCES:
        if path != ROOT / "raster" / "kernel.py":
            assert not compiler.search(path.read_text()), f"{path}: use @kernel from raster/kernel.py"


def test_no_kernel_is_made_of_a_source_that_the_name_of_the_cache_leaves_out():
    folder = Path(kernel.__file__).parent
    left_out = {path.relative_to(folder) for path in folder.rglob("*.py")} - set(
        kernel.kernel_sources(folder)
    )
    assert left_out
    packages = {package_of(folder / path) for path in left_out}
    for package in packages:
        # Those that keep compiled kernels ask Numba for its settings, and make no kernel.
        keeps_kernels = package.startswith("raster/kernel_")
        makers = {"raster/kernel"} if keeps_kernels else {"numba", "llvmlite", "raster/kernel"}
        assert not imports()[package] & makers, package
    packages = {package for package in packages if not package.startswith("raster/kernel_")}
    for path in kernel.kernel_sources(folder):
        assert not imports_of(folder / path, ast.parse((folder / path).read_text())) & packages, path


@pytest.mark.parametrize("path", REFERENCE, ids=lambda path: path.stem)
def test_every_reference_function_names_its_source(path):
    functions = [n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.FunctionDef)]
    for node in functions:
        text = ast.get_docstring(node) or ""
        is_known = node.name == "__init__" or any(tag in text for tag in EVIDENCE_TAGS)
        assert is_known, f"{path.stem}.{node.name} needs its source"


BIBLIOGRAPHY = frozenset(
    re.findall(r"^@\w+\{([^,\s]+),", (ROOT / "docs" / "bibliography.bib").read_text(), re.MULTILINE)
)


@pytest.mark.parametrize("collection", [FIGURES, STUDIES], ids=["figures", "studies"])
def test_every_figure_and_study_names_a_paper_of_the_bibliography(collection):
    missing = [
        f"{each.id} is of {each.source!r}" for each in collection.values() if each.source not in BIBLIOGRAPHY
    ]
    assert not missing, (
        f"{'; '.join(missing)}: docs/bibliography.bib has no such entry. Write it, or name another."
    )


def test_every_figure_has_an_accepted_digest_on_every_machine_and_every_digest_a_figure():
    accepted = {path.stem for path in (ROOT / "tests" / "golden").glob("*.json")}
    assert accepted == {f"{f.id}-{machine}" for f in FIGURES.values() for machine in f.machines}


def is_figure(name):
    """Whether a dotted name is a figure's module."""
    return name.startswith("fixedpipe.effects.figures.") and re.match(r"[a-z]\d\d", name.split(".")[-1])


# By a figure's number, or the letter of the technique that it shows, its paper's folder.
PAPERS = {
    **dict.fromkeys(("F000", "H"), "heidrich_2001"),
    **dict.fromkeys(("F001", "S"), "schilling_1997"),
    **dict.fromkeys(("F002", "T002", "G"), "heidrich_2000"),
    **dict.fromkeys(("F003", "Z"), "zwicker_2016"),
    **dict.fromkeys(("F004", "K"), "kautz_seidel_2000"),
}


@pytest.mark.parametrize("figure_id", FIGURES)
def test_a_figure_lies_in_its_paper_s_folder(figure_id):
    *_, folder, _ = FIGURES.module_of(figure_id).split(".")
    if figure_id[0] == OWN:
        return
    assert folder == PAPERS[re.match(r"[FT]\d{3}|[A-Z]", figure_id)[0]]


def is_study(name):
    """Whether a dotted name is a study's module."""
    return re.match(r"fixedpipe\.effects\.studies\.p\d\d", name)


def test_figures_and_studies_share_by_their_folder_and_take_nothing_from_another():
    for path in sorted((ROOT / "effects" / "figures").glob("*/**/*.py")):
        paper = ".".join(("fixedpipe", *path.relative_to(ROOT).parts[:3]))
        for name in imported_modules(ast.parse(path.read_text())):
            assert not is_figure(name) and not is_figure(name.rpartition(".")[0]), path
            module = name if name in MODULES else name.rpartition(".")[0]
            if re.match(r"fixedpipe\.effects\.figures\.\w+_\d{4}", module):
                assert module.startswith(paper), f"{path} imports {name}"
    for path in sorted((ROOT / "effects" / "studies").rglob("*.py")):
        assert not [name for name in imported_modules(ast.parse(path.read_text())) if is_study(name)], path
