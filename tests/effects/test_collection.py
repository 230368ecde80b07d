"""Figures and studies by their ids: what is imported and when, their order, and modules that disagree."""

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

from fixedpipe.effects.collection import Collection
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.studies import STUDIES

COLLECTIONS = {"figures.FIGURES": (FIGURES, "K12"), "studies.STUDIES": (STUDIES, "P9")}


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A function that makes a package of modules, path to text, and imports it."""

    def make(modules):
        for path, text in modules.items():
            file = tmp_path / "things" / path
            file.parent.mkdir(parents=True, exist_ok=True)
            (file.parent / "__init__.py").touch()
            file.write_text(text)
        (tmp_path / "things" / "__init__.py").touch()
        return importlib.import_module("things")

    monkeypatch.syspath_prepend(tmp_path)
    yield make
    for name in [name for name in sys.modules if name.partition(".")[0] == "things"]:
        del sys.modules[name]


@pytest.mark.parametrize(("name", "sentence"), [("F004-44", "Did you mean F004-4?"), ("x", "There are: ")])
def test_an_id_that_nobody_has_is_a_key_error_that_is_a_sentence(name, sentence):
    with pytest.raises(KeyError) as raised:
        FIGURES[name]
    assert str(raised.value).startswith(f"There is no figure {name!r}.") and sentence in str(raised.value)
    assert len(str(raised.value)) < 100
    assert name not in FIGURES and FIGURES.get(name) is None


def holds(identifier):
    return f"from types import SimpleNamespace\nTHING = SimpleNamespace(id={identifier!r})\n"


def identify(name):
    found = re.fullmatch(r"([a-z]+\d+)_\w+", name)
    return found and found[1].upper()


def collected(package):
    return Collection(package, "THING", identify, "a1_words for A1", beside=("helper",))


def loaded_by(statements):
    """The names of all modules that Python has after some statements, in a process of their own."""
    code = f"import sys\n{statements}\nprint(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


@pytest.mark.parametrize("place", COLLECTIONS)
def test_listing_imports_no_module_of_a_figure_or_a_study(place):
    collection, _ = COLLECTIONS[place]
    package, _, name = place.partition(".")
    listing = f"from fixedpipe.effects.{package} import {name}\nassert len(list({name})) == {len(collection)}"
    loaded = loaded_by(listing)
    assert collection.module_of(next(iter(collection))).rpartition(".")[0] in loaded
    assert not loaded & {collection.module_of(identifier) for identifier in collection}


@pytest.mark.parametrize("place", COLLECTIONS)
def test_who_asks_for_one_imports_what_it_needs_and_no_other(place):
    collection, identifier = COLLECTIONS[place]
    package, _, name = place.partition(".")
    loaded = loaded_by(f"from fixedpipe.effects.{package} import {name}\n{name}[{identifier!r}]")
    others = (FIGURES.module_of(i) for i in FIGURES), (STUDIES.module_of(i) for i in STUDIES)
    assert loaded & {module for modules in others for module in modules} == {collection.module_of(identifier)}
    beyond = {
        module for module in loaded if re.match(r"fixedpipe\.effects\.(cli|reports|conformance)\b", module)
    }
    assert not beyond and not loaded & {"click", "rich", "matplotlib"}


def test_a_module_is_imported_when_its_id_is_asked_for(package):
    things = collected(package({"a1_good.py": holds("A1"), "deeper/a2_bad.py": "raise RuntimeError('read')"}))
    assert list(things) == ["A1", "A2"] and "A2" in things
    assert things["A1"].id == "A1"
    with pytest.raises(RuntimeError, match="read"):
        things["A2"]
    with pytest.raises(KeyError):
        things["A3"]


def test_ids_come_in_the_order_of_their_numbers(package):
    names = ("b2_x", "a10_x", "deeper/a9_x", "deeper/b1_x", "a1_x", "helper", "deeper/shared/no_id")
    things = collected(package({f"{name}.py": "" for name in names}))
    assert list(things) == ["A1", "A9", "A10", "B1", "B2"]
    assert things.module_of("A9") == "things.deeper.a9_x"


@pytest.mark.parametrize("second", ["a1_second.py", "deeper/a1_second.py"])
def test_a_second_claimant_of_an_id_is_refused(package, second):
    found = package({"a1_first.py": holds("A1"), second: holds("A1")})
    with pytest.raises(ValueError, match=r"both claim A1\. Give one another id") as error:
        collected(found)
    module = second.removesuffix(".py").replace("/", ".")
    assert "things.a1_first " in str(error.value) and f"things.{module} " in str(error.value)


def test_a_module_whose_name_disagrees_with_what_it_holds_is_refused(package):
    things = collected(package({"a1_first.py": holds("A1"), "a2_second.py": holds("A3")}))
    assert things["A1"].id == "A1"
    with pytest.raises(ValueError, match=r"things.a2_second claims A2 by its name, and holds A3\."):
        things["A2"]


@pytest.mark.parametrize("name", ["toon", "deeper/a_2", "deeper/helper"])
def test_a_module_that_would_not_be_found_is_refused_by_how_to_name_it(package, name):
    found = package({f"{name}.py": holds("A1")})
    module = re.escape(f"things.{name}".replace("/", "."))
    with pytest.raises(Refusal, match=rf"^{module} is named by no id, .* Call it a1_words for A1;"):
        collected(found)


def test_a_folder_that_is_no_package_is_refused(package):
    found = package({"a1_first.py": holds("A1"), "deeper/a2_second.py": holds("A2")})
    folder = Path(found.__path__[0]) / "deeper"
    (folder / "__init__.py").unlink()
    with pytest.raises(Refusal, match=r"^The folder deeper of things has no __init__\.py, .* Give it one"):
        collected(found)
    (folder / "a2_second.py").unlink()
    assert list(collected(found)) == ["A1"]


def test_what_refuses_to_be_made_is_refused_by_its_module_and_its_sentence(package):
    things = collected(package({"a1_first.py": "raise ValueError('A1 names a machine twice.')"}))
    with pytest.raises(Refusal, match=r"^things\.a1_first cannot be used: A1 names a machine twice\.$"):
        things["A1"]


def test_a_module_that_holds_nothing_is_refused_by_what_to_write(package):
    things = collected(package({"a1_first.py": "FIGURE = 1"}))
    with pytest.raises(Refusal, match=r"things\.a1_first claims A1 .* holds no THING\. End it with THING = "):
        things["A1"]
