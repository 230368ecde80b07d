"""``fixedpipe golden review`` in a terminal: keys, pictures in half blocks, and what is said without one."""

import os
import subprocess
import sys

import numpy as np
import pytest

from fixedpipe.pipeline.framebuffers.pictures import whole_png
from fixedpipe.pipeline.golden.candidates import (
    CHANGED,
    NEW,
    Candidate,
    read_candidates,
    write_candidate,
    write_run,
)
from fixedpipe.pipeline.golden.store import change_store, golden_of, picture_path, read_store, write_whole

termios = pytest.importorskip("termios", reason="there are no pseudo-terminals")
PICTURE = np.random.default_rng(5).integers(0, 256, (6, 8, 4), np.uint8)
OTHER = PICTURE.copy()
OTHER[2:5, 3:7, 0] ^= 3
NAMES = ["test_a.py::a", "test_a.py::b", "test_a.py::new"]
COMMAND = [sys.executable, "-m", "fixedpipe.effects.cli", "golden", "review"]


@pytest.fixture
def root(tmp_path):
    """A project where a and b differ and one picture is new."""
    store, run = tmp_path / "golden" / "test_a.json", {}
    for name in NAMES:
        key = name.partition("::")[2]
        expected, status = (None, NEW) if key == "new" else (golden_of(PICTURE).sha256, CHANGED)
        if expected:
            change_store(store, {key: golden_of(PICTURE)})
            write_whole(picture_path(store, key), whole_png(PICTURE))
        said = f"told of {key}"
        waiting = Candidate(name, "golden/test_a.json", key, status, golden_of(OTHER), expected, said)
        write_candidate(tmp_path, waiting, OTHER)
        run[name] = {"status": status, "store": "golden/test_a.json", "key": key, "test": name}
    write_run(tmp_path, run)
    return tmp_path


def typed(root, keys, term="xterm-256color"):
    """(exit status, what a terminal shows) where keys are pressed, each once it is asked for; the last must
    end the program.
    """
    ours, theirs = os.openpty()
    kept = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "COLORTERM", "FORCE_COLOR")}
    process = subprocess.Popen(
        COMMAND,
        cwd=root,
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env=kept | {"TERM": term, "COLUMNS": "120"},
    )
    os.close(theirs)
    shown, waiting = b"", list(keys)
    try:
        while data := os.read(ours, 65536):
            shown += data
            if shown.count(b"end: ") > len(keys) - len(waiting):
                if not waiting:  # it asks for more keys than there are: a failure, not a wait
                    process.kill()
                    continue
                # What is typed before it waits for a key is thrown away, as by any program of one key.
                while termios.tcgetattr(ours)[3] & termios.ICANON and process.poll() is None:
                    pass
                os.write(ours, waiting.pop(0).encode())
    except OSError:  # how Linux says that the other end is closed
        pass
    os.close(ours)
    return process.wait(), shown.decode()


def test_keys_accept_leave_show_and_end(root):
    status, shown = typed(root, ["d", "a", "x", "s", "a"])
    assert (status, "2 accepted." in shown) == (0, True), shown
    assert f"(3, 2): {tuple(PICTURE[2, 3].tolist())}, now {tuple(OTHER[2, 3].tolist())}" in shown
    assert "and 2 more" in shown
    assert "test_a.py::a: 12 pixels differ by at most 3" in shown
    pictures = read_store(root / "golden" / "test_a.json")
    assert {key: p.sha256 == golden_of(OTHER).sha256 for key, p in pictures.items()} == {
        "a": True,
        "b": False,
        "new": True,
    }
    assert list(read_candidates(root)) == ["test_a.py::b"]


@pytest.mark.parametrize("key", ["q", "\x03", "\x04"])
def test_what_was_not_looked_at_stays(root, key):
    before = (root / "golden" / "test_a.json").read_bytes()
    status, shown = typed(root, ["s", key])
    assert (status, "0 accepted, 2 left." in shown) == (0, True), shown
    assert (root / "golden" / "test_a.json").read_bytes() == before
    assert len(read_candidates(root)) == 3


def test_pictures_are_drawn_where_there_are_colours(root):
    _, shown = typed(root, ["q"])
    assert all(title in shown for title in ("golden", "now", "where"))
    assert shown.count("\u2580") == 3 * 8 * 3
    assert "\u2580" not in typed(root, ["q"], term="dumb")[1]


def test_a_damaged_file_of_one_picture_is_told_and_the_others_are_looked_at(root):
    picture_path(root / "golden" / "test_a.json", "a").write_bytes(b"version https://git-lfs.example\n")
    before = (root / "golden" / "test_a.json").read_bytes()
    # b comes first, whose difference can be told. The damaged one cannot be accepted.
    status, shown = typed(root, ["s", "a"])
    assert (status, "take it from version control again" in shown) == (2, True), shown
    assert (root / "golden" / "test_a.json").read_bytes() == before
    status, shown = typed(root, ["a", "s", "a"])
    assert (status, "2 accepted." in shown) == (0, True), shown
    assert "no whole PNG file" in shown


def test_without_a_terminal_a_sentence_says_what_to_do(root):
    done = subprocess.run(
        COMMAND,
        cwd=root,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        start_new_session=True,
    )
    assert done.returncode == 2
    assert "a keyboard, and there is none here. Write the page instead, with --html" in done.stderr
    assert "Traceback" not in done.stderr
