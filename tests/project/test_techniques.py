"""Every id has a meaning: what techniques declare, figures name, and docs/papers/index.md has of both."""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

from fixedpipe.effects import technique
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.technique import Technique, Variant
from tests import techniques

ROOT = Path(__file__).parents[2]
CLAIMED = [technique.id for _, technique in techniques.claims()]
# Folders of techniques, and their modules that are none.
FOLDERS = (
    "bump_mapping",
    "environment_maps",
    "radiosity",
    "reflectance",
    "scattering",
    "shadows",
    "texture_filtering",
    "volumes",
)
HELPERS = {
    "effects/environment_maps/environment_lights.py",
    "effects/environment_maps/environments.py",
    "effects/radiosity/form_factors.py",
    "effects/radiosity/light_maps.py",
    "effects/radiosity/small_room.py",
    "effects/reflectance/fresnel.py",
    "effects/reflectance/hemisphere_maps.py",
    "effects/reflectance/sampled_functions.py",
    "effects/scattering/directions.py",
    "effects/scattering/height_field.py",
    "effects/scattering/long_work.py",
    "effects/scattering/made_fields.py",
    "effects/scattering/merl.py",
    "effects/scattering/turning_sun.py",
    "effects/volumes/engine_block.py",
    "effects/volumes/slices.py",
}
# The catalogue has entries of what is not drawn, too: test_catalogue.py.
CATALOGUE = ROOT / "docs" / "papers" / "catalogue"
TEXTS = [
    *sorted(ROOT.glob("*.md")),
    *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page.parent != CATALOGUE),
    *sorted((ROOT / "effects").rglob("*.py")),
]


def mentioned(pattern):
    """What a pattern finds in pages and in the docstrings, comments and strings of modules: {id: a file}."""
    return {
        found: str(path.relative_to(ROOT)) for path in TEXTS for found in pattern.findall(path.read_text())
    }


def test_the_page_is_as_it_is_generated():
    assert techniques.PAGE.read_text() == techniques.page(), "make techniques"


def test_no_id_is_claimed_twice():
    assert [identifier for identifier, count in Counter(CLAIMED).items() if count > 1] == []
    assert set(CLAIMED) & techniques.NAMED.keys() == set()


@pytest.mark.parametrize("collection", [FIGURES, STUDIES], ids=["figures", "studies"])
def test_what_figures_and_studies_name_some_module_is(collection):
    for identifier, each in collection.items():
        assert set(each.techniques) <= set(CLAIMED), identifier
        assert len(set(each.techniques)) == len(each.techniques), identifier


def test_what_a_row_of_the_brdfs_names_some_module_is():
    assert {row.technique for row in BRDFS.values()} <= set(CLAIMED)


def test_every_technique_is_shown_by_a_figure():
    assert {each for each in CLAIMED if not techniques.users(each, FIGURES)} == set()


def test_another_way_is_to_what_another_module_is():
    owners = {technique.id: path for path, technique in techniques.claims()}
    for path, each in techniques.declared():
        if isinstance(each, Variant):
            assert each.ids, path
            for identifier in each.ids:
                assert owners.get(identifier, path) != path, f"{path}: no other module is {identifier}"


def test_every_module_of_techniques_declares_what_it_is():
    declaring = {path for path, _ in techniques.declared()}
    modules = {
        str(path.relative_to(ROOT))
        for folder in FOLDERS
        for path in (ROOT / "effects" / folder).rglob("*.py")
        if path.name != "__init__.py"
    }
    assert modules - declaring == HELPERS
    assert all(path.startswith("effects/passes/") for path in declaring - modules)


def test_what_a_module_declares_stands_directly_under_its_imports():
    for path in dict.fromkeys(path for path, _ in techniques.declared()):
        body = ast.parse((ROOT / path).read_text()).body
        after = [node for node in body[1:] if not isinstance(node, (ast.Import, ast.ImportFrom))]
        assert isinstance(after[0], ast.Assign) and after[0].targets[0].id == "TECHNIQUES", path


def test_every_technique_s_id_that_is_mentioned_is_in_the_index():
    found = mentioned(re.compile(r"\b([HZKSG]\d\d)\b"))
    known = {*CLAIMED, *techniques.NAMED}
    assert {identifier: path for identifier, path in found.items() if identifier not in known} == {}
    assert techniques.NAMED.keys() <= found.keys()


def test_every_study_that_is_mentioned_is_there():
    found = mentioned(re.compile(r"\b(P(?:[4-9]|[1-9]\d))\b"))  # P0 to P3 are passes.
    assert {identifier: path for identifier, path in found.items() if identifier not in STUDIES} == {}


def test_every_erratum_that_is_mentioned_is_on_its_document_s_page():
    for erratum, path in mentioned(re.compile(r"\b(E00\d\.\d+)\b")).items():
        page = (ROOT / "docs" / "papers" / techniques.PAGES[erratum[1:4]]).read_text()
        assert re.search(rf"\b{re.escape(erratum)}\b", page), f"{path} names {erratum}"


@pytest.mark.parametrize("name", techniques.PAGES.values())
def test_the_table_of_a_document_s_page_names_the_module_that_is_the_technique(name):
    text = (techniques.PAGE.parent / name).read_text().split("\n## Techniques\n")[1].split("\n## ")[0]
    owners, places, above = {technique.id: path for path, technique in techniques.claims()}, {}, ""
    for line in re.findall(r"^\| \[?[HKZGS]\d\d.*", text, re.MULTILINE):
        ids, _, where, *_ = (cell.strip() for cell in line.strip("|").split(" | "))
        if same := re.search(r"the same(?: as ([HKZGS]\d\d))?", where):
            where += places.get(same[1], above)
        places |= dict.fromkeys(re.findall(r"[HKZGS]\d\d", ids), where)
        above = where
    assert len(places) >= 7
    for identifier in places.keys() & owners.keys():
        named = re.findall(r"`(effects/[^`]+)`", places[identifier])
        assert not named or owners[identifier] in named, f"{identifier} is {owners[identifier]}"


def test_an_effect_of_one_s_own_has_a_letter_of_its_own():
    assert technique.OWN not in technique.PAPERS
    assert Technique(f"{technique.OWN}07", "what", "1").id == "X07"


@pytest.mark.parametrize("identifier", ["K7", "Y07", "k07", "K007", 7])
def test_an_id_of_no_paper_is_refused(identifier):
    with pytest.raises(ValueError, match="no technique's id"):
        Technique(identifier, "what", "1")
    with pytest.raises(ValueError, match="no technique's id"):
        Variant(("K07", identifier), "how")


def test_ids_are_a_tuple():
    with pytest.raises(ValueError, match=r"The ids are 'K07'; give a tuple of them: \('K07',\)"):
        Variant("K07", "how")
