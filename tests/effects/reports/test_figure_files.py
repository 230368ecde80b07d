"""The gallery's folder: what a record says and names, that nothing is there twice, and what goes."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from fixedpipe.effects.bibliography import citation
from fixedpipe.effects.cli import main
from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.figures.figure import Method
from fixedpipe.effects.presentation.animations import ANIMATIONS
from fixedpipe.effects.reports.figure_files import digests_in, tidy
from fixedpipe.effects.reports.figure_record import plain_values, render, steps
from fixedpipe.effects.reports.pictures import canonical, digest_of
from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.framebuffers.pictures import deep_picture
from tests.effects.reports import kept
from tests.pipeline.framebuffers.test_pictures import decoded
from tests.support.few_figures import Few

SIZE = 24
TWELVE = "INFINITE_REALITY"


def run(*arguments):
    done = CliRunner().invoke(main, [str(a) for a in arguments])
    assert done.exit_code == 0, done.output
    return done


def files(folder):
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """F004-2 on all its machines, and every picture as PNG."""
    folder = tmp_path_factory.mktemp("gallery")
    run("figures", "F004-2", "--size", SIZE, "--out", folder / "out", "--png", folder / "png")
    return folder


@pytest.mark.parametrize("figure", FIGURES.values(), ids=FIGURES)
def test_a_figures_own_values_have_a_form_in_json(figure):
    """Numbers are numbers, members of enums names, as the command line takes them."""
    for values in (figure.values, *(figure.values_of(method) for method in figure.methods)):
        said = json.loads(json.dumps(plain_values(figure, values)))
        assert set(said) == set(values)
    if figure.id == "F002-1":
        assert said["accumulation"] == "ACCUMULATION_BUFFER"


def test_a_record_says_what_a_gallery_shows(drawn):
    record, figure = kept.record(drawn / "out", "F004-2"), FIGURES["F004-2"]
    assert [machine["profile"] for machine in record["machines"]] == list(figure.machines)
    paper = citation(figure.source)
    assert record["citation"] == {
        "authors": paper.authors,
        "title": paper.title,
        "year": paper.year,
        "key": figure.source,
        "bibtex": paper.bibtex,
    }
    assert record["command"] == f"fixedpipe figures F004-2 --size {SIZE}"
    assert record["panels"] == [
        {"x": n * SIZE, "y": 0, "width": SIZE, "height": SIZE, "label": label}
        for n, label in enumerate(figure.panels)
    ]
    for machine in record["machines"]:
        found = figure.render(machine["profile"], SIZE)
        assert (machine["name"], machine["bits"]) == (found.profile.name, found.bits)
        difference = found.difference
        # FLIP is of each method's first machine, where its library is there.
        assert {name: value for name, value in machine["difference"].items() if name != "flip"} == {
            "identical": False,
            "gain": difference.gain,
            "rms": difference.rms,
            "max": difference.largest,
            "at": list(difference.at),
            "pixels": difference.pixels,
        }
        caption = machine["pictures"]["difference"]["caption"]
        assert caption == f"(machine - ideal) x {difference.gain} about middle grey"


def test_every_picture_comes_back_bit_for_bit(drawn):
    for machine in kept.record(drawn / "out", "F004-2")["machines"]:
        found = FIGURES["F004-2"].render(machine["profile"], SIZE)
        pictures = machine["pictures"]
        for view, wanted in (("machine", found.codes()), ("ideal", found.ideal.codes(found.bits))):
            picture = pictures[view]
            assert (picture["width"], picture["height"], picture["bits"]) == (2 * SIZE, SIZE, found.bits)
            assert ("delta" in picture or picture["finer"] is not None) == (found.bits > 8)
            np.testing.assert_array_equal(kept.codes(drawn / "out", picture), wanted[..., :3])
        shown = kept.pixels(drawn / "out", pictures["machine"]["digest"])
        np.testing.assert_array_equal(shown, canonical(found.image()[..., :3]))
        assert digest_of(shown) == pictures["machine"]["digest"]


def test_a_machine_that_drew_the_same_bits_says_which_drew_them_first(drawn):
    machines = kept.record(drawn / "out", "F004-2")["machines"]
    first = {}
    for machine in machines:
        picture = machine["pictures"]["machine"]
        bits = picture["digest"], picture["finer"]
        assert machine["same_bits_as"] == first.get(bits)
        first.setdefault(bits, machine["profile"])
    assert 1 < len(first) < len(machines)


def test_the_first_machine_of_each_method_has_previews_and_passes(drawn):
    record, methods = kept.record(drawn / "out", "F004-2"), set()
    there = files(drawn / "out")
    for machine in record["machines"]:
        is_first = machine["method"] not in methods
        methods.add(machine["method"])
        assert ("passes" in machine) == ("digest" in machine["pictures"]["difference"]) == is_first
        if not is_first:
            continue
        for view in ("machine", "ideal", "difference"):
            assert f"pictures/{machine['pictures'][view]['digest']}.webp" in there
        assert machine["passes"][-1]["preview"] == machine["pictures"]["machine"]["digest"]
        assert all(f"pictures/{one['preview']}.webp" in there for one in machine["passes"])
        numbers = [one["number"] for one in machine["passes"]]
        assert numbers == sorted(set(numbers)) and len(numbers) > 1
    thumbnails = {name for name in there if name.endswith("-480.webp")}
    assert thumbnails == {f"pictures/{record['machines'][0]['pictures']['machine']['digest']}-480.webp"}


def test_nothing_is_written_that_no_record_names(drawn):
    named = digests_in((drawn / "out" / "F004-2.json").read_text())
    assert {Path(name).name[:16] for name in files(drawn / "out") if name.startswith("pictures/")} == named
    assert files(drawn / "out") - {name for name in files(drawn / "out") if name.startswith("pictures/")} == {
        *("index.html", "plain.html", "F004-2.json", "records/F004-2.js"),
        *(f"catalogue/{name}.html" for name in ("000", "001", "002", "003", "004", "artefacts", "README")),
    }


def test_png_files_have_readable_names_and_all_bits(drawn):
    machines = FIGURES["F004-2"].machines
    views = "", "-ideal", "-difference"
    assert files(drawn / "png") == {f"F004-2-{machine}{view}.png" for machine in machines for view in views}
    found = FIGURES["F004-2"].render(TWELVE, SIZE)
    for view, codes in (("", found.codes()), ("-ideal", found.ideal.codes(12))):
        data = (drawn / "png" / f"F004-2-{TWELVE}{view}.png").read_bytes()
        np.testing.assert_array_equal(decoded(data), deep_picture(codes, 12)[..., :3])
    with Image.open(drawn / "png" / f"F004-2-{TWELVE}-difference.png") as picture:
        np.testing.assert_array_equal(np.asarray(picture), found.difference.image()[..., :3])
    with Image.open(drawn / "png" / "F004-2-OCTANE.png") as picture:
        wanted = FIGURES["F004-2"].render("OCTANE", SIZE).image()
        np.testing.assert_array_equal(np.asarray(picture), wanted[..., :3])


def test_what_is_there_is_not_written_again(tmp_path):
    small = "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path
    run("figures", "K12", *small)
    (picture,) = (tmp_path / "pictures").glob("*-480.webp")
    marked = b'marked")\n' if picture.suffix == ".js" else b"RIFF\x06\x00\x00\x00marked"
    picture.write_bytes(marked)
    run("figures", "K12", *small)
    assert picture.read_bytes() == marked
    for damaged in (b"", marked[:-1]):
        picture.write_bytes(damaged)
        run("figures", "K12", *small)
        assert len(picture.read_bytes()) > len(marked)


def test_what_no_record_names_goes_and_what_is_not_ours_stays(tmp_path):
    def draw(figure, size):
        return run("figures", figure, "--size", size, "--profile", "GEFORCE_256", "--out", tmp_path)

    draw("K02", 8)
    draw("K12", 8)
    before, other = files(tmp_path), digests_in((tmp_path / "K02.json").read_text())
    first = digests_in((tmp_path / "K12.json").read_text()) - other
    foreign = [
        "K12-GEFORCE_256.png",  # of a gallery's former layout
        "notes.txt",
        "0123456789abcdef.webp",
        "pictures/holiday.webp",
        "pictures/0123456789abcdef.png",
        "pictures/0123456789abcdef-960.webp",
        "pictures/0123456789ABCDEF.js",
        "pictures/folder/0123456789abcdef.js",
        "records/mine.js",
        "records/K12.txt",
    ]
    stale = ["pictures/0123456789abcdef.js", "pictures/0123456789abcdef-480.webp", "records/K12+cells=8.js"]
    (tmp_path / "pictures" / "folder").mkdir()
    for name in (*foreign, *stale):
        (tmp_path / name).write_text("anything")
    draw("K12", 9)
    now = files(tmp_path)
    assert set(foreign) <= now and not set(stale) & now
    names = {Path(name).name[:16] for name in now - set(foreign)}
    assert not names & first and other <= names
    assert {name for name in before if name.startswith("pictures/") and Path(name).name[:16] in other} <= now
    late = tmp_path / "pictures" / "fedcba9876543210.js"
    late.write_text("of another run, whose record is yet to come")
    number, size = tidy(tmp_path, FIGURES, [tmp_path / name for name in now])
    assert late.is_file()
    assert (number, size) == (2, sum((tmp_path / name).stat().st_size for name in now - set(foreign)))


def test_what_a_picture_is_told_from_stays(tmp_path):
    run("figures", "K02", "--size", 32, "--profile", "GEFORCE_256", "--out", tmp_path)
    record = json.loads((tmp_path / "K02.json").read_text())
    machine, ideal = (record["machines"][0]["pictures"][view]["digest"] for view in ("machine", "ideal"))
    script = (tmp_path / "pictures" / f"{ideal}.js").read_bytes()
    assert script.endswith(f'","{machine}")\n'.encode())
    # Another record names the ideal alone.
    record["machines"][0]["pictures"].pop("machine")
    (tmp_path / "K02.json").write_text(json.dumps(record))
    tidy(tmp_path, FIGURES, [tmp_path / name for name in files(tmp_path)])
    assert (tmp_path / "pictures" / f"{machine}.js").is_file()


@pytest.mark.parametrize("spoil", [lambda text: text[:200], lambda text: "\udcff" + text, lambda text: "[1"])
def test_no_picture_goes_where_a_record_cannot_be_read(tmp_path, spoil):
    run("figures", "K02", "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path)
    record = tmp_path / "K02.json"
    record.write_bytes(spoil(record.read_text()).encode(errors="surrogateescape"))
    before = files(tmp_path)
    tidy(tmp_path, FIGURES, [tmp_path / name for name in before])
    assert {name for name in before if name.startswith("pictures/")} <= files(tmp_path)


def test_a_record_may_be_formatted_otherwise(tmp_path):
    run("figures", "K02", "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path)
    record = tmp_path / "K02.json"
    record.write_text(json.dumps(json.loads(record.read_text()), separators=(",", ":")))
    before = files(tmp_path)
    tidy(tmp_path, FIGURES, [tmp_path / name for name in before])
    assert files(tmp_path) == before


def test_records_of_the_former_layout_are_set_aside_and_kept(tmp_path):
    """A gallery that was begun by an earlier version goes on, and nothing of it is lost."""
    former = '{"id": "K02", "difference_gain": 8.0, "machines": []}'
    for name in ("K02.json", "K02+cells=8.json", "mine.json"):
        (tmp_path / name).write_text(former)
    done = run("figures", "K12", "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path)
    assert "2 records of an earlier version now end in .former." in done.stderr
    for name in ("K02.json.former", "K02+cells=8.json.former", "mine.json"):
        assert (tmp_path / name).read_text() == former
    assert "1 figure in" in done.stdout
    again = run("figures", "K12", "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path)
    assert "earlier" not in again.stderr
    (tmp_path / "K02.json").write_text(former + " ")
    (tmp_path / "K12+cells=9.json").mkdir()
    run("figures", "K12", "--size", 8, "--profile", "GEFORCE_256", "--out", tmp_path)
    assert (tmp_path / "K02.json.former").read_text() == former
    assert (tmp_path / "K02.json.former.2").read_text() == former + " "


def cleared(profile, size):
    return (Clear(label="clear", color=(0.3, 0.5, 0.7, 1.0)),)


def reference(size):
    picture = np.full((size, 2 * size, 4), 1.0)
    picture[:, :size, :3] = 0.25
    picture[:, size:, 3] = 0.0
    return picture


@pytest.fixture
def plain(monkeypatch):
    """A figure that is one colour, right to the last bit, with a reference that is not, of the left panel."""
    methods = Method("a clear", cleared, ("GEFORCE_256", "NV2A", TWELVE)), Method("too", cleared, ("OCTANE",))
    monkeypatch.delitem(ANIMATIONS, "K12")  # what moves there is a parameter that this one lacks
    return replace(
        FIGURES["K12"],
        panels=("left", "right"),
        parameters={},
        methods=methods,
        acceptance=lambda *_: (),
        reference=reference,
    )


def test_what_is_identical_is_said_and_not_drawn(tmp_path, monkeypatch, plain):
    monkeypatch.setattr("fixedpipe.effects.figures.FIGURES", Few(K12=plain))
    run("figures", "K12", "--size", 8, "--out", tmp_path / "out", "--png", tmp_path / "png")
    for machine in kept.record(tmp_path / "out", "K12")["machines"]:
        said = machine["difference"]
        assert said["identical"] and said["at"] is None and said["pixels"] == 0 and said["max"] < 0.002
        assert machine["pictures"]["difference"] == {
            "caption": "identical: no code of the machine differs from the ideal's, rounded"
        }
    views = "", "-ideal", "-reference", "-reference-difference"
    assert files(tmp_path / "png") == {f"K12-{m}{view}.png" for m in plain.machines for view in views}


def test_a_reference_is_kept_with_its_alpha_and_compared_where_it_is(plain):
    lines = []
    rendered = render(plain, plain.machines, 8, 1, False, lines.append)
    assert len(lines) + 1 == steps(plain, plain.machines, False) == 2 * 4 + 2 + 1
    assert sum("reference" in line for line in lines) == 2
    for machine in rendered.record["machines"]:
        found, said = machine["pictures"]["reference"], machine["reference_difference"]
        pixels = rendered.pictures.pixels[found["digest"]]
        assert (pixels[:, :8] == [64, 64, 64, 255]).all() and not pixels[:, 8:].any()
        one = 2 ** machine["bits"] - 1
        machine_codes = np.floor(np.array([0.3, 0.5, 0.7]) * one + 0.5)
        assert (said["identical"], said["pixels"], said["at"]) == (False, 64, [0, 0])
        np.testing.assert_allclose(said["max"], machine_codes[2] / one - 0.25)
        assert machine["pictures"]["reference_difference"]["caption"].startswith("(machine - reference) x ")
        if found["finer"]:
            finer = rendered.pictures.pixels[found["finer"]][:, :8, :3].astype(int)
            assert (np.floor(64 * 4095 / 255 + 0.5) + finer - 128 == np.floor(0.25 * 4095 + 0.5)).all()
    digests = {machine["pictures"]["reference"]["digest"] for machine in rendered.record["machines"]}
    assert len(digests) == 1


def test_every_figure_has_a_page_in_the_catalogue_and_a_paper():
    from fixedpipe.effects.reports.figure_record import _page

    root = Path(__file__).parents[3]
    for figure in FIGURES.values():
        page, anchor = _page(figure).split("#")
        assert f'<a id="{anchor}"></a>' in (root / page).read_text()
        assert citation(figure.source).title
    assert _page(replace(FIGURES["K12"], id="X01")) is None


def test_a_figure_whose_paper_has_no_entry_yet_is_drawn_with_the_key_alone():
    figure = replace(FIGURES["K12"], source="Nobody1999")
    record = render(figure, ("GEFORCE_256",), 8, 1, False, lambda _: None).record
    assert record["citation"] == {"authors": "", "title": "", "year": "", "key": "Nobody1999", "bibtex": ""}


@pytest.mark.parametrize("machines", [("GEFORCE_256",), ("GEFORCE_256", "NV2A"), ("IDEAL",)])
def test_as_many_steps_are_announced_as_come(machines):
    figure, lines = FIGURES["K12"], []
    render(figure, machines, 8, 1, machines != ("IDEAL",), lines.append)
    assert len(lines) + 1 == steps(figure, machines, machines != ("IDEAL",))  # and one for writing
