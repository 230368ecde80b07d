"""Stores of golden pictures: what a person reads there, and what happens where they cannot be kept."""

import errno
import json
import multiprocessing
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden import candidates, store
from fixedpipe.pipeline.golden.accepting import accept_where_sound
from fixedpipe.pipeline.golden.candidates import CHANGED, NEW, Candidate, accept, write_candidate
from fixedpipe.pipeline.golden.store import (
    Passed,
    StoreError,
    change_store,
    file_name,
    from_text,
    golden_of,
    picture_path,
    plain_key,
    read_store,
    to_text,
    variant_key,
)
from fixedpipe.pipeline.selftest import quick

PICTURE = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
OTHER = PICTURE ^ np.uint8(1)
PASSES = (
    Passed("black", "Clear", ("00000000", "11111111", "22222222")),
    Passed('a "label", über', "Draw", ("3", "4", "5"), (("fragment", "6"),)),
)


def test_a_store_is_sorted_and_has_a_line_for_each_picture():
    pictures = {
        "test_b[1]": golden_of(PICTURE, PASSES, {"profile": "GeForce 256"}),
        "test_a": golden_of(OTHER),
    }
    text = to_text(pictures)
    lines = text.splitlines()
    assert len(lines) == 4
    assert lines[1].startswith('  "test_a": {"size": [3, 2, 4], "dtype": "uint8", "sha256": "')
    assert lines[2].startswith('  "test_b[1]": ')
    assert text == to_text(dict(reversed(pictures.items())))
    assert from_text(text, Path("s.json")) == pictures


LINE = to_text({"test_a": golden_of(PICTURE)})
UNREADABLE = {
    "markers of a merge": (f"<<<<<<< HEAD\n{LINE}=======\n{LINE}>>>>>>> theirs\n", "line 1: a merge left"),
    "half a file": (LINE[:60], "cannot be read"),
    "nothing": ("", "cannot be read"),
    "another file": ('{"a": 1}', "is no file of golden pictures"),
    "a list": ("[]", "is no file of golden pictures"),
    "a later format": (
        LINE.replace('"format": 1', '"format": 2'),
        "has the format 2; this fixedpipe reads 1",
    ),
    "a digest that is none": (LINE.replace('"sha256": "', '"sha256": "x'), "which is no SHA-256"),
    "no digest": (LINE.replace("sha256", "md5"), "it is no golden picture"),
    "a size that is none": (LINE.replace("[3, 2, 4]", "[3, 0, 4]"), "its size, type or passes are none"),
    "too many components": (LINE.replace("[3, 2, 4]", "[3, 2, 5]"), "its size, type or passes are none"),
    "another type": (LINE.replace("uint8", "float32"), "its size, type or passes are none"),
    "a word too many": (LINE.replace('"dtype"', '"tolerance": 3, "dtype"'), "it has tolerance"),
    "a picture twice": (
        LINE.replace('  "test_a"', '  "test_a": {},\n  "test_a"'),
        "'test_a' stands there twice; keep one line",
    ),
    "a number for a picture": ('{"format": 1, "pictures": {"test_a": 3}}', "it is no golden picture"),
}


@pytest.mark.parametrize("name", UNREADABLE)
def test_a_store_that_cannot_be_read_is_a_sentence_and_stays(tmp_path, name):
    text, sentence = UNREADABLE[name]
    path = tmp_path / "test_a.json"
    path.write_text(text)
    with pytest.raises(StoreError) as refused:
        read_store(path)
    assert sentence in str(refused.value)
    assert str(path) in str(refused.value)
    with pytest.raises(StoreError):
        change_store(path, {"test_b": golden_of(PICTURE)})
    assert path.read_text() == text


def test_bytes_and_folders_are_no_store(tmp_path):
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "folder.json").mkdir()
    for name, sentence in (("bytes", "is no text"), ("folder", "cannot be read: Is a directory")):
        with pytest.raises(StoreError, match=sentence):
            read_store(tmp_path / f"{name}.json")
    assert read_store(tmp_path / "none.json") == {}


def full(*arguments, **named):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize("when", ["fsync", "replace"])
def test_a_full_disc_leaves_what_was_there(tmp_path, monkeypatch, when):
    path = tmp_path / "golden" / "test_a.json"
    change_store(path, {"test_a": golden_of(PICTURE)})
    before = path.read_text()
    monkeypatch.setattr(store.os if when == "fsync" else store.Path, when, full)
    with pytest.raises(StoreError, match=r"No space left on device.*is unchanged"):
        change_store(path, {"test_a": golden_of(OTHER)})
    monkeypatch.undo()
    assert path.read_text() == before
    assert [p.name for p in path.parent.iterdir()] == [path.name]


def add(path, number, start):
    start.wait()
    change_store(Path(path), {f"test_{number}": golden_of(PICTURE)})


def test_who_accept_at_once_lose_no_line(tmp_path):
    path, context = tmp_path / "golden" / "test_a.json", multiprocessing.get_context("spawn")
    start = context.Barrier(6)
    processes = [context.Process(target=add, args=(str(path), number, start)) for number in range(6)]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    assert read_store(path).keys() == {f"test_{number}" for number in range(6)}


def test_names_of_files():
    names = [
        "lit",
        "Lit",
        "a/b",
        "a-b",
        "a b",
        "test[x-1]",
        "test[x/1]",
        ".",
        "..",
        "x" * 200,
        "ü",
        "é",
        "CON.",
    ]
    files = [file_name(name) for name in names]
    assert files[0] == "lit"
    assert len({name.lower() for name in files}) == len(names)
    for name in files:
        assert "/" not in name and len(name) < 80 and name.isascii() and not name.startswith((".", "-"))


# ---------------------------------------------------------------------------------------------- candidates


def candidate(pixels, expected=None, key="test_a", keep=True):
    status = NEW if expected is None else CHANGED
    golden = golden_of(pixels)
    return Candidate(
        f"tests/test_a.py::{key}", "tests/golden/test_a.json", key, status, golden, expected, "", keep
    )


@pytest.fixture
def accepted(tmp_path):
    """A root where PICTURE is golden, and OTHER waits."""
    first = candidate(PICTURE)
    write_candidate(tmp_path, first, PICTURE)
    assert accept(tmp_path, first) == "tests/test_a.py::test_a: new, 3x2 pixels of colour and alpha, uint8"
    changed = candidate(OTHER, first.golden.sha256)
    write_candidate(tmp_path, changed, OTHER)
    return tmp_path, changed


def kept(root):
    path = root / "tests" / "golden" / "test_a.json"
    picture = picture_path(path, "test_a")
    return path.read_text(), picture.read_bytes() if picture.exists() else None


def test_accepting_says_what_changed_and_forgets_the_candidate(accepted):
    root, changed = accepted
    assert list(candidates.read_candidates(root)) == [changed.name]
    assert "6 pixels differ by at most 1" in accept(root, changed)
    text, picture = kept(root)
    assert json.loads(text)["pictures"]["test_a"]["sha256"] == changed.golden.sha256
    assert picture == whole_png(OTHER)
    assert candidates.read_candidates(root) == {}
    assert (root / ".golden" / ".gitignore").read_text().endswith("*\n")


def test_without_png_files_none_is_left(accepted):
    root, changed = accepted
    plain = candidate(OTHER, changed.expected, keep=False)
    write_candidate(root, plain, OTHER)
    accept(root, plain)
    assert kept(root)[1] is None


@pytest.mark.parametrize("failing", [1, 2])
def test_what_cannot_be_written_whole_changes_nothing(accepted, monkeypatch, failing):
    """The store is written first, its picture then; a disc that is full at either leaves both."""
    root, changed = accepted
    before, calls, write = kept(root), [], store.write_whole

    def some(path, data):
        calls.append(path)
        if len(calls) == failing:
            raise StoreError(f"{path} cannot be written: no space.")
        write(path, data)

    monkeypatch.setattr(store, "write_whole", some)
    monkeypatch.setattr(candidates, "write_whole", some)
    with pytest.raises(StoreError, match="no space"):
        accept(root, changed)
    assert kept(root) == before
    assert list(candidates.read_candidates(root)) == [changed.name]


def test_what_was_accepted_otherwise_meanwhile_is_not_overwritten(accepted):
    root, changed = accepted
    change_store(root / changed.store, {"test_a": golden_of(PICTURE + np.uint8(9))})
    before = kept(root)
    with pytest.raises(StoreError, match="was accepted otherwise since the tests ran"):
        accept(root, changed)
    assert kept(root) == before


@pytest.mark.parametrize("changed_since", ["test_a", "test_a:mesa", None])
def test_a_variant_is_accepted_against_the_plain_picture_that_it_was_compared_with(accepted, changed_since):
    root, changed = accepted
    variant = replace(changed, name="a:mesa", key="test_a:mesa", against="test_a")
    write_candidate(root, variant, OTHER)
    if changed_since:
        change_store(root / variant.store, {changed_since: golden_of(PICTURE + np.uint8(9))})
        before = kept(root)
        with pytest.raises(StoreError, match="was accepted otherwise since the tests ran"):
            accept(root, variant)
        assert kept(root) == before
        return
    plain = kept(root)[1]
    assert accept(root, variant).startswith("a:mesa: 6 pixels differ by at most 1")
    assert read_store(root / variant.store) == {
        "test_a": golden_of(PICTURE),
        "test_a:mesa": golden_of(OTHER),
    }
    assert kept(root)[1] == plain
    assert picture_path(root / variant.store, "test_a:mesa").read_bytes() == whole_png(OTHER)


def test_what_another_run_accepted_just_so_is_no_error(accepted):
    root, changed = accepted
    change_store(root / changed.store, {"test_a": changed.golden})
    before = kept(root)
    assert accept(root, changed) == "tests/test_a.py::test_a: golden already, as it was drawn"
    assert kept(root) == before
    assert candidates.read_candidates(root) == {}


def test_a_candidate_whose_picture_was_changed_is_not_accepted(accepted):
    root, changed = accepted
    (png,) = (root / ".golden" / "candidates").glob("*.png")
    png.write_bytes(whole_png(PICTURE))
    before = kept(root)
    with pytest.raises(
        StoreError, match="has other pixels than those of the recorded digest; run the tests again"
    ):
        accept(root, changed)
    png.write_bytes(png.read_bytes()[:40])
    with pytest.raises(StoreError, match="no whole PNG file"):
        accept(root, changed)
    assert kept(root) == before


def test_a_candidate_that_is_none_is_said(accepted):
    root, _ = accepted
    (described,) = (root / ".golden" / "candidates").glob("*.json")
    described.write_text(described.read_text()[:30])
    with pytest.raises(StoreError, match="is no candidate"):
        candidates.read_candidates(root)


def test_a_place_without_a_run_is_said(tmp_path):
    with pytest.raises(StoreError, match="Run pytest first"):
        candidates.workplace(tmp_path)
    (tmp_path / ".golden").mkdir()
    assert candidates.workplace(tmp_path / "tests" / "deep") == tmp_path
    with pytest.raises(StoreError, match="no run of pytest ended there"):
        candidates.read_run(tmp_path)
    (tmp_path / ".golden" / "run.json").write_text("{}")
    with pytest.raises(StoreError, match="run pytest again"):
        candidates.read_run(tmp_path)


def test_nothing_is_accepted_where_the_self_test_fails(accepted, monkeypatch):
    root, changed = accepted
    before = kept(root)
    monkeypatch.setattr(quick, "failures", lambda: ("One frame differs.", "Another one."))
    with pytest.raises(StoreError, match=r"Nothing was accepted.*One frame differs. \(and 1 more\)"):
        accept_where_sound(root, [changed])
    assert kept(root) == before
    assert accept_where_sound(root, []) == []
    monkeypatch.setattr(quick, "failures", tuple)
    assert len(accept_where_sound(root, [changed])) == 1
    assert kept(root) != before


def test_a_store_that_an_editor_gave_a_byte_order_mark_is_read(tmp_path):
    path = tmp_path / "test_a.json"
    text = to_text({"test_a": golden_of(PICTURE)})
    path.write_text(text, encoding="utf-8-sig")
    assert read_store(path) == from_text(text, path)
    change_store(path, {"test_b": golden_of(OTHER)})
    assert sorted(read_store(path)) == ["test_a", "test_b"]


_TESTS = st.from_regex(r"(TestA::)?test_[a-z]{1,3}(\[[^\n]{1,9}\])?(::[^/\\\\:\n]{1,9})?", fullmatch=True)


@given(_TESTS, st.from_regex(r"[A-Za-z0-9_.+-]{1,40}", fullmatch=True))
def test_a_variant_s_name_is_no_other_picture_s(key, variant):
    assert plain_key(key) == key
    assert plain_key(variant_key(key, variant)) == key
    assert variant_key(key, None) == key


@pytest.mark.parametrize("variant", ["", "a" * 41, "a:b", "a/b", "a b", "ü", "a\n", 3])
def test_what_is_no_variant_s_name(variant):
    with pytest.raises(ValueError, match="1 to 40 ASCII letters"):
        variant_key("test_lit", variant)
