"""The whole site, as ``make site`` builds it, in a browser."""

import pytest

pytest.importorskip("sphinx", reason="no Sphinx: make setup installs it")

from docs.site import code_pages
from docs.site.__main__ import build
from docs.site.check import faults
from docs.site.stage import stage

LARGEST = 60_000_000  # bytes of the whole site. Assumed: what a page of a project may hold

# What the theme and the extensions still call, and the next Sphinx renames.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::PendingDeprecationWarning")


def no_passes(figure_id, machine):
    """In the place of passes, which take seconds a figure."""
    return f"passes of {figure_id} on {machine}"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The site of all pages, built without passes: (Sphinx's status, the folder)."""
    folder = tmp_path_factory.mktemp("whole")
    code = stage(folder / "source", no_passes, None, folder / "site")
    status = build(folder / "source", folder / "site")
    code_pages.write(code, folder / "site")
    return status, folder / "site"


@pytest.mark.slow
def test_the_site_is_whole(whole):
    status, site = whole
    assert status == 0 and faults(site) == []
    assert sum(path.stat().st_size for path in site.rglob("*") if path.is_file()) < LARGEST


@pytest.mark.slow
def test_the_site_is_searched_from_a_file_and_asks_no_other_host(whole, visit_folder):
    page = visit_folder(whole[1])
    assert page.title()
    page.goto((whole[1] / "search.html").as_uri() + "?q=anisotropic")
    page.wait_for_selector("#search-results li a")
    assert page.locator("#search-results li").count() > 1
