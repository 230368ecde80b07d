"""The documentation says only what is so: its examples run, its links lead somewhere."""

import doctest
import pkgutil
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.profiles import GEFORCE_256

ROOT = Path(__file__).parents[2]
COMMANDS = main.list_commands(None)
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


def test_the_readme_example_gives_what_it_says():
    results = doctest.testfile(str(ROOT / "README.md"), module_relative=False)
    assert results.attempted >= 5
    assert results.failed == 0


@pytest.mark.parametrize(
    "page",
    [
        "precision",
        "machine-beside-ideal",
        "reading-guide",
        "from-python",
        "pages-and-slides",
        "inspecting",
        "coming-from",
    ],
)
def test_a_page_s_example_gives_what_it_says(page):
    results = doctest.testfile(str(ROOT / "docs" / f"{page}.md"), module_relative=False)
    assert results.attempted >= 5
    assert results.failed == 0


def picture_of_the_readme(name):
    """The pixels of a picture that the README shows, [h, w, 3]."""
    path = f"docs/images/{name}.png"
    assert f'src="{path}"' in (ROOT / "README.md").read_text()
    return np.asarray(Image.open(ROOT / path))


def test_the_readme_bump_command_draws_the_readme_picture(tmp_path):
    pytest.importorskip("skimage")
    (command,) = re.findall(r"fixedpipe (bump .*) --out gravel.png", (ROOT / "README.md").read_text())
    out = tmp_path / "gravel.png"
    result = CliRunner().invoke(main, [*command.split(), "--out", str(out)])
    assert result.exit_code == 0, result.output
    np.testing.assert_array_equal(np.asarray(Image.open(out)), picture_of_the_readme("gravel-sphere"))


def test_the_readme_shows_the_figure_as_it_is_drawn_now():
    figure = FIGURES["F004-4"]
    commands = figure.commands(GEFORCE_256, 384)
    image = execute(commands, GEFORCE_256, *figure.dimensions(384)).framebuffer.color[..., :3]
    np.testing.assert_array_equal(image, picture_of_the_readme("F004-4"))


def test_every_number_of_the_readme_s_evidence_stands_on_the_page_that_it_names():
    readme = (ROOT / "README.md").read_text()
    section = readme.partition("## How it is known to be right")[2].partition("\n## ")[0]
    rows = re.findall(r"^\|[^|]+\|([^|]+)\| \[[^]]+\]\(([^)]+)\) \|$", section, re.MULTILINE)
    numbers = [(number, page) for cell, page in rows for number in re.findall(r"\d+(?:,\d{3})*", cell)]
    assert len(rows) >= 4 and len(numbers) >= 8
    for number, page in numbers:
        assert re.search(rf"(?<![\d,]){number}(?![\d,])", (ROOT / page).read_text()), (number, page)


def test_the_readme_fits_on_two_screens():
    assert len((ROOT / "README.md").read_text().splitlines()) <= 120


def test_the_citation_names_the_version_and_the_licence_of_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    citation = (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^version: (\S+)$", citation, re.MULTILINE)[1] == project["version"]
    assert re.search(r"^license: (\S+)$", citation, re.MULTILINE)[1] == project["license"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_link_leads_somewhere(page):
    for target in re.findall(r"\]\(([^)#\s]+)", page.read_text()):
        assert target.startswith("http") or (page.parent / target).exists(), target


def anchors(page):
    """What links may name behind a "#": a page's headings as GitHub spells them, and ids of its own."""
    text = re.sub(r"^```[\s\S]*?^```", "", page.read_text(), flags=re.MULTILINE)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w -]", "", h.lower()).replace(" ", "-") for h in headings} | set(
        re.findall(r'<a id="([^"]+)">', text)
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_link_into_a_page_names_a_part_of_it(page):
    for target, anchor in re.findall(r"\]\(([^)#\s:]*\.md|)#([^)\s]+)\)", page.read_text()):
        assert anchor in anchors(page.parent / target if target else page), f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_file_that_is_named_exists(page):
    for name in re.findall(r"`((?:raster|pipeline|effects|tests|docs|bench)/[\w/.-]+)`", page.read_text()):
        assert (ROOT / name).exists() or (ROOT / f"{name}.py").exists(), name


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_command_that_is_named_is_there(page):
    text = page.read_text()
    for name in re.findall(r"(?:^ {4}|^\$ |`)(?:\.venv/bin/)?fixedpipe\s([a-z0-9]+)", text, re.MULTILINE):
        assert name in COMMANDS, name


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_module_that_is_named_is_named_with_its_folders(page):
    for name in re.findall(r"`([\w/-]+\.py)`", page.read_text()):
        assert (ROOT / name).exists(), name


def test_every_neighbour_that_the_recipes_search_for_is_there():
    page = (ROOT / "docs" / "adding-things.md").read_text()
    names = [name for found in re.findall(r"git grep -\w+ '([^']+)'", page) for name in found.split("\\|")]
    assert len(names) > 10
    folders = (ROOT / folder for folder in ("raster", "pipeline", "effects"))
    sources = "\n".join(path.read_text() for folder in folders for path in folder.rglob("*.py"))
    assert [name for name in names if name not in sources] == []


def test_every_file_of_the_engines_diagram_lies_in_its_folder():
    """The diagram of docs/architecture.md has two columns, each with folders and below them their files."""
    page = (ROOT / "docs" / "architecture.md").read_text()
    lines = [
        line for line in page.splitlines() if line.startswith("        ") and ("│" in line or "►" in line)
    ]
    middle, folders, seen = next(line.rindex("──►") for line in lines if "raster/vector/" in line), {}, 0
    for line in lines:
        for column, part in enumerate((line[:middle], line[middle:])):
            for name in re.findall(r"[\w/]+/(?= |$)", part):
                folders[column] = name
                assert (ROOT / name).is_dir(), name
            for name in re.findall(r"\w+\.py", part):
                assert (ROOT / folders[column] / name).exists(), (folders[column], name)
                seen += 1
    assert seen > 15


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_every_name_that_can_be_imported_is_there(page):
    for name in re.findall(r"`(fixedpipe(?:\.\w+)+)(?:\(\w*\))?`", page.read_text()):
        assert pkgutil.resolve_name(name), name


def test_every_decision_is_in_the_index():
    index = (ROOT / "docs" / "decisions" / "README.md").read_text()
    for page in (ROOT / "docs" / "decisions").glob("[0-9]*.md"):
        assert page.name in index, page.name
