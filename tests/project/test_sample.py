"""What `make test` takes of many tests that are alike: by the change's date, never by a clock."""

from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.figures import FIGURES
from tests.support import sample

DATES = [f"2001-05-{day:02}T10:00:00+00:00" for day in range(1, 32)]


@pytest.fixture
def at(monkeypatch):
    """at(date, *files): what is taken after a change of that date, of these files."""

    def change(date, *files):
        monkeypatch.setenv(sample.DATE, date)
        monkeypatch.setenv(sample.CHANGED, "\n".join(files))

    return change


def test_a_change_is_tested_alike_again_and_every_case_has_its_turn(at):
    taken = {}
    for date in DATES:
        at(date)
        taken[date] = sample.sampled(range(20))
        assert sample.sampled(range(20)) == taken[date]
        assert len(taken[date]) in (3, 4)
    assert set.union(*taken.values()) == set(range(20))
    shares = {frozenset(cases) for cases in taken.values()}
    assert len(shares) == 6 and sum(map(len, shares)) == 20  # none in two


def test_a_figure_that_changed_is_looked_at_whoever_s_turn_it_is(at):
    for date in DATES[:6]:
        at(date, "effects/figures/kautz_seidel_2000/k12_normalization_cube_map.py")
        found = sample.sampled_figures()
        at(date)
        assert found == sample.sampled_figures() | {"K12"}
        assert len(FIGURES) / 8 < len(found) < len(FIGURES) / 4


class Item:
    """A test as pytest collects it."""

    def __init__(self, nodeid):
        self.nodeid, self.marks = nodeid, []

    def add_marker(self, mark):
        self.marks.append(mark.name)


def run_now(*folders):
    """The tests of folders, twenty in each, that `make test` runs after the change."""
    items = [Item(f"{folder}/test_a.py::test_b[{n}]") for folder in folders for n in range(20)]
    sample.take_turns(items)
    return {item.nodeid for item in items if "slow" not in item.marks}


def test_tests_have_their_turns_and_those_of_a_package_that_changed_all_run(at):
    cli, always = "tests/effects/cli", "tests/project"
    taken = []
    for date in DATES:
        at(date)
        taken.append(run_now(cli))
        assert len(run_now(always)) == 20
        at(date, "effects/cli/view.py")
        assert len(run_now(cli)) == 20 > len(run_now("tests/raster"))
        at(date, "raster/vector/band.py")
        assert len(run_now("tests/raster/vector", "tests/raster")) == 40 and len(run_now(cli)) < 20
        at(date, f"{cli}/test_c.py")
        assert len(run_now(cli)) == 20
    assert len(set.union(*taken)) == 20 and len(set(map(frozenset, taken))) == sample.SHARE


def test_a_change_of_many_folders_is_tested_by_larger_shares_alone(at):
    wide = [f"effects/{n}/a.py" for n in range(sample.WIDE)]
    cli, taken = "tests/effects/cli", []
    for date in DATES:
        at(date, *wide[1:], "effects/cli/view.py")
        assert len(run_now(cli)) == 20
        at(date, *wide, "effects/cli/view.py")
        taken.append(run_now(cli))
        assert len(run_now(cli)) < 20 and len(sample.sampled(range(18))) == 6
    assert len(set.union(*taken)) == 20 and len(set(map(frozenset, taken))) == sample.WIDE_SHARE


@pytest.mark.parametrize(
    ("test", "of"),
    [
        ("tests/pipeline/golden/test_a.py::test_b", ("tests/pipeline/golden/", "pipeline/golden/")),
        ("tests/pipeline/test_a.py::test_b", ("tests/pipeline/", "pipeline/")),
        ("tests/effects/cli/test_a.py::test_b", ("tests/effects/cli/", "effects/cli/")),
        ("tests/raster/vector/test_a.py::test_b", ("tests/raster/", "raster/", "tests/reference/")),
        ("tests/project/test_bench_runs.py::test_b", ("tests/project/test_bench", "bench/")),
        ("tests/effects/test_figures.py::test_b", ()),
        ("tests/project/test_docs.py::test_b", ()),
        ("tests/golden/test_golden.py::test_b", ()),
    ],
)
def test_a_test_is_of_the_package_whose_name_its_folder_has(test, of):
    assert sample.sources_of(test) == of


def test_every_folder_of_tests_that_take_turns_has_a_package():
    root = sample.Path(sample.__file__).parents[2]
    for path in root.glob("tests/**/test_*.py"):
        own, *sources = sample.sources_of(path.relative_to(root).as_posix()) or (None,)
        assert all((root / source).is_dir() for source in sources), path
        assert own is None or list(root.glob(f"{own}*")), path


def test_without_git_a_share_is_taken_as_well(monkeypatch):
    monkeypatch.delenv(sample.DATE, raising=False)
    monkeypatch.delenv(sample.CHANGED, raising=False)
    assert sample.sampled(range(20)) and not sample.changed()


@pytest.mark.parametrize(
    ("asked", "share", "tried"), [(300, 3, 100), (300, 1, 300), (60, 3, 30), (20, 3, 20)]
)
def test_a_share_of_hypothesis_s_examples_is_tried(asked, share, tried):
    seen = []

    @settings(max_examples=asked, database=None)
    @given(st.integers(0, 1 << 40))
    def looks(number):
        seen.append(number)

    sample.fewer_examples([SimpleNamespace(obj=looks), SimpleNamespace()], share)
    looks()
    assert len(seen) == tried
