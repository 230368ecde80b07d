"""The site: pages that a browser opens from a folder, whose links lead somewhere and whose ids have names."""

import re
from itertools import chain

import pytest

pytest.importorskip("sphinx", reason="no Sphinx: make setup installs it")

from docs.site import code_pages, figure_pages, sphinx_extension
from docs.site.__main__ import build
from docs.site.api_pages import commands, topics
from docs.site.check import faults
from docs.site.stage import INDEX, Links, contents, sections

# What the theme and the extensions still call, and the next Sphinx renames.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::PendingDeprecationWarning")


def no_passes(figure_id, machine):
    """In the place of passes, which take seconds a figure."""
    return f"passes of {figure_id} on {machine}"


# ------------------------------------------------------------------------------------------- before Sphinx


def test_a_link_to_code_leads_to_its_page_and_one_to_a_page_stays():
    links = Links(["docs/papers/index.md", "docs/install.md", INDEX])
    text = "[a](../install.md#b) [c](../../effects/technique.py) [d](../../README.md) [e](#f) [g](https://h)"
    assert links.of("docs/papers/index.md", text) == (
        "[a](../install.md#b) [c](code:effects/technique.py) [d](../../index.md) [e](index.md#f) [g](https://h)"
    )
    assert links.code == {"effects/technique.py"}


def test_a_file_that_is_named_gets_a_page_and_one_that_is_not_there_gets_none():
    links = Links([])
    links.of("a.md", "`effects/technique.py` and `effects/nothing.py`")
    assert links.code == {"effects/technique.py"}


def test_every_page_stands_in_the_contents_once_and_where_the_guide_has_it():
    guide = "# Where\n\n## Use it\n\n[i](install.md) [i](install.md#a)\n\n## Trust it\n\n"
    guide += "[i](install.md) [n](numbers.md)\n"
    assert sections(guide) == [
        ("Use it", ["docs/install.md", "docs/install.md"]),
        ("Trust it", ["docs/install.md", "docs/numbers.md"]),
    ]
    names = [
        "docs/reading-guide.md",
        "docs/install.md",
        "docs/numbers.md",
        "docs/new.md",
        INDEX,
        "figures/K02.md",
    ]
    assert contents(names, guide) == [
        ("Begin here", ["docs/reading-guide.md"]),
        ("Use it", ["docs/install.md"]),
        ("Trust it", ["docs/numbers.md"]),
        ("More pages", ["docs/new.md"]),
    ]


def test_the_pipeline_s_docstring_has_a_topic_for_every_name():
    import fixedpipe.pipeline as pipeline

    found, left = topics(pipeline.__doc__, pipeline.__all__)
    assert left == set() and sorted(chain.from_iterable(found.values())) == pipeline.__all__
    assert found["what comes of it"] == ["Result", "Fragments", "IdealResult"]
    assert topics(pipeline.__doc__, [*pipeline.__all__, "Novelty"])[1] == {"Novelty"}


def test_every_command_and_subcommand_has_its_help():
    found = dict(commands())
    assert {"fixedpipe", "fixedpipe figures", "fixedpipe golden accept"} <= set(found)
    assert "Usage: fixedpipe figures" in found["fixedpipe figures"]


def test_passes_stand_below_the_pictures_of_a_paper_s_page_and_of_no_other():
    text = 'Words.\n\n<img src="../images/F004-8-OCTANE.png" width="9%">\n\nMore.\n'
    found = figure_pages.beside("docs/papers/004.md", text, no_passes)
    assert re.search(
        r"F004-8-OCTANE.*<summary>F004-8 on .*Octane.*passes of F004-8 on OCTANE.*More", found, re.S
    )
    assert figure_pages.beside("docs/gallery.md", text, no_passes) == text


def test_long_passes_are_cut_and_say_how_to_print_the_rest():
    page = figure_pages.Pages(lambda *_: "<line>\n" * (figure_pages.LINES + 5))
    from fixedpipe.effects.figures import FIGURES

    text = page.page(FIGURES["K02"])
    assert "… 5 more lines: fixedpipe passes K02 --profile GEFORCE_256" in text
    assert text.count("<line>") == figure_pages.LINES


def test_passes_are_those_that_the_command_prints():
    assert "specular pass" in figure_pages.described("F004-5", "GEFORCE_256")


# -------------------------------------------------------------------------------------------- a small site


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """Two pages, built: (Sphinx's status, the folder)."""
    source = tmp_path_factory.mktemp("small") / "source"
    catalogue = source / "docs" / "papers" / "catalogue"
    catalogue.mkdir(parents=True)
    (catalogue / "004.md").write_text('# Catalogue\n\n<a id="k07"></a>K07 is this.\n')
    (source / INDEX).write_text(
        "# Home\n\nK07 and [K10](docs/papers/catalogue/004.md#k07), `K07`, `effects/technique.py`, "
        "[the code](code:effects/technique.py), P99.\n\n```{toctree}\ndocs/papers/catalogue/004\n```\n"
    )
    out = source.parent / "site"
    status = build(source, out)
    code_pages.write({"effects/technique.py"}, out)
    return status, out


def test_a_small_site_is_whole(small):
    status, site = small
    assert status == 0 and faults(site) == []


def test_an_id_in_prose_is_a_link_with_its_name_and_code_is_none(small):
    text = (small[1] / "index.html").read_text()
    name = sphinx_extension.names()["K07"]
    (link,) = re.findall(r"<a [^>]*>K07</a>", text)
    assert 'href="docs/papers/catalogue/004.html#k07"' in link and f'title="{name}"' in link
    assert ">K07</span></code>" in text and re.search(r"P99\.</p>", text)
    (given,) = re.findall(r"<a [^>]*>(?:<span[^>]*>)?K10(?:</span>)?</a>", text)
    assert 'title="' + sphinx_extension.names()["K10"][:20] in given


def test_a_file_that_a_page_names_is_a_link_to_its_code(small):
    text = (small[1] / "index.html").read_text()
    assert text.count('href="code/effects/technique.py.html"') == 2
    assert "Technique" in (small[1] / "code/effects/technique.py.html").read_text()


def test_a_link_that_leads_nowhere_fails_the_build(tmp_path, capsys):
    (tmp_path / "source").mkdir()
    (tmp_path / "source" / INDEX).write_text("# Home\n\n[There](#nowhere) and [page](nothing.md).\n")
    assert build(tmp_path / "source", tmp_path / "site") == 1
    assert "nowhere" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("html", "wrong"),
    [
        ('<a href="nothing.html">a</a>', "nothing.html, which is not there"),
        ('<a href="#nothing">a</a>', "#nothing, whose part is not there"),
        ('<script src="https://cdn.example/a.js"></script>', "loads https://cdn.example/a.js"),
        ('<img src="//cdn.example/a.png">', "loads //cdn.example/a.png"),
    ],
)
def test_a_fault_of_a_site_is_seen(tmp_path, html, wrong):
    (tmp_path / "a.html").write_text(html)
    assert wrong in faults(tmp_path)[0]


def test_a_link_to_another_host_that_nothing_loads_is_no_fault(tmp_path):
    (tmp_path / "a.html").write_text('<a href="https://example.org/" id="b">a</a><a href="#b">b</a>')
    assert faults(tmp_path) == []
