"""A browser for the tests of the gallery: Chromium of the system, or Playwright's own."""

import shutil
from functools import partial
from pathlib import Path

import pytest

from tests.browser.made_gallery import make_gallery

HANGS = 300_000.0  # milliseconds: what takes longer is taken to hang
INSTALLED = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="session")
def browser():
    playwright = pytest.importorskip("playwright.sync_api", reason="no Playwright: make setup installs it")
    with playwright.sync_playwright() as running:
        path = next(filter(None, map(shutil.which, INSTALLED)), running.chromium.executable_path)
        if not Path(path).is_file():
            pytest.skip("no browser: install chromium, or run `.venv/bin/playwright install chromium`")
        # As root in a container there is no sandbox, and no GPU.
        opened = running.chromium.launch(
            executable_path=path, args=["--no-sandbox", "--disable-gpu"], timeout=HANGS
        )
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def made(tmp_path_factory):
    return make_gallery(tmp_path_factory.mktemp("gallery"))


@pytest.fixture
def visit(visit_folder, made):
    """Opens the made gallery: visit("#K12", width=420) gives the page."""
    return partial(visit_folder, made.folder)


@pytest.fixture
def visit_folder(browser):
    """Opens the gallery of a folder: visit_folder(folder, "#K12", width=420) gives the page, whose errors and
    whose requests that leave the folder fail the test.
    """
    contexts, wrong = [], []

    def opened(folder, address="", width=1400, height=900, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        context.set_default_timeout(HANGS)
        contexts.append(context)
        page = context.new_page()
        home = (folder / "index.html").as_uri()
        inside = folder.as_uri()
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on("request", lambda r: r.url.startswith((inside, "blob:", "data:")) or wrong.append(r.url))
        page.goto(home + address)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert wrong == []
