"""What windows and the viewer say to each other: nothing is lost, nothing but what is allowed is heard."""

import json
import threading
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.viewer import conversation, worker
from fixedpipe.effects.viewer.conversation import IN_FLIGHT, Conversation
from fixedpipe.effects.viewer.encoding import Sent, decoded, differing, encoded
from fixedpipe.effects.viewer.studio import Picture, Studio, Superseded
from fixedpipe.effects.viewer.subjects import FigureSubject, Subjects
from fixedpipe.effects.viewer.views import LONGEST_TEXT, View, to_object, view_of
from fixedpipe.effects.viewer.worker import Request, Worker
from tests.support.waiting import until

SPHERES = View("F004-4", "GEFORCE_256", 32)


# ------------------------------------------------------------------------------------------------ pictures


def pictures(shape, bits):
    most = 2**bits - 1
    kind = np.uint8 if bits <= 8 else np.uint16
    random = np.random.default_rng(shape[0] * 31 + shape[1] + bits)
    codes = random.integers(0, most + 1, (*shape, 4)).astype(kind)
    return Picture(codes, bits)


@settings(deadline=None)
@given(
    st.tuples(st.integers(1, 9), st.integers(1, 9)),
    st.sampled_from([5, 8, 12, 16]),
    st.booleans(),
    st.data(),
)
def test_what_is_sent_is_read_bit_for_bit(shape, bits, deflated, data):
    first = pictures(shape, bits)
    second = Picture(first.codes.copy(), bits)
    for _ in range(data.draw(st.integers(0, 3))):
        y, x = (data.draw(st.integers(0, n - 1)) for n in shape)
        second.codes[y, x] ^= 1
    header, whole = decoded(encoded(first, None, {"number": 1}, deflated), None)
    np.testing.assert_array_equal(whole.codes, first.codes)
    assert header["base"] is None and header["number"] == 1
    message = encoded(second, Sent(1, first), {"number": 2}, deflated)
    header, found = decoded(message, whole)
    np.testing.assert_array_equal(found.codes, second.codes)
    assert found.codes.dtype == first.codes.dtype


def test_only_the_rectangle_that_differs_is_sent():
    first = pictures((20, 30), 8)
    second = Picture(first.codes.copy(), 8)
    second.codes[5, 7] ^= 1
    second.codes[9, 4] ^= 1
    assert differing(second, first) == (4, 5, 4, 5)
    assert differing(first, first) == (0, 0, 0, 0)
    assert differing(first, None) == differing(first, pictures((20, 31), 8)) == (0, 0, 30, 20)
    assert differing(first, pictures((20, 30), 12)) == (0, 0, 30, 20)


# --------------------------------------------------------------------------------------------------- views


def test_a_view_comes_back_from_its_object():
    view = View("F004-4", "NV2A", 96, (("light", "1,1,1"),), (("combiner", 6),), ("BLENDING",), 7)
    assert view_of(json.loads(json.dumps(to_object(view)))) == view
    assert view_of({"id": "F004-4", "machine": "NV2A"}) == View("F004-4", "NV2A")


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
    max_leaves=12,
)


@settings(deadline=None)
@given(VALUES | st.fixed_dictionaries({name: VALUES for name in to_object(SPHERES)}))
def test_any_object_is_a_view_or_refused_in_a_sentence(given_object):
    try:
        found = view_of(given_object)
    except Refusal as error:
        assert str(error).endswith(".") and len(str(error)) < 300
    else:
        assert view_of(to_object(found)) == found


@pytest.mark.parametrize(
    "wrong",
    [
        {"values": {"light": "1" * (LONGEST_TEXT + 1)}},
        {"values": {str(n): "1" for n in range(1000)}},
        {"without": ["BLENDING"] * 1000},
        {"size": 4096},
        {"size": True},
        {"upto": -1},
        {"bits": {"combiner": 6.0}},
        {"id": 4},
    ],
)
def test_what_is_too_much_is_refused(wrong):
    with pytest.raises(Refusal):
        view_of(to_object(SPHERES) | wrong)


# -------------------------------------------------------------------------------------------------- worker


class Drawing:
    """A studio whose pictures take as long as it is told."""

    def __init__(self):
        self.go, self.begun, self.drawn = threading.Semaphore(0), [], []

    def machine(self, view, stop=lambda: False):
        self.begun.append(view)
        while not self.go.acquire(blocking=False):
            if stop():
                raise Superseded
        self.drawn.append(view)
        return view

    def guided(self, view, stop):
        return self.machine(view, stop), "ideal", {}


def views(count):
    return [replace(SPHERES, upto=number) for number in range(count)]


@pytest.fixture
def drawing(monkeypatch):
    made, told = Drawing(), []
    lasting = Worker(made, lambda *what: told.append(what))
    yield made, lasting, told
    monkeypatch.setattr(worker, "_PATIENCE", 0.0)
    lasting.ask(Request(10**6, SPHERES))
    lasting.close(wait=True)


def test_the_newest_request_wins_and_none_between_is_drawn(drawing):
    studio, lasting, told = drawing
    asked = views(50)
    lasting.ask(Request(0, asked[0]))
    until(lambda: studio.begun)
    for serial, view in enumerate(asked[1:], 1):
        lasting.ask(Request(serial, view))
    studio.go.release()
    studio.go.release()
    until(lambda: len(studio.drawn) == 2)
    assert studio.drawn == [asked[0], asked[-1]]
    until(lambda: len(told) == 2)
    assert [(what, serial) for what, serial, _ in told] == [("picture", 0), ("picture", 49)]


def test_a_long_picture_is_given_up_for_a_newer_one(drawing, monkeypatch):
    monkeypatch.setattr(worker, "_PATIENCE", 0.0)
    studio, lasting, _ = drawing
    first, second = views(2)
    lasting.ask(Request(0, first))
    until(lambda: studio.begun)
    lasting.ask(Request(1, second))
    until(lambda: len(studio.begun) == 2)
    studio.go.release()
    until(lambda: studio.drawn)
    assert studio.drawn == [second]


def test_the_ideal_follows_at_rest_and_an_answer_goes_before_it(drawing):
    studio, lasting, told = drawing
    lasting.ask(Request(0, SPHERES, wants=frozenset({"ideal"})))
    studio.go.release()
    until(lambda: len(studio.begun) == 2, "the ideal")  # its thread waits in it
    lasting.aside("history", 7, lambda: "all of it")
    until(lambda: ("answer", 7, "all of it") in told)
    studio.go.release()
    until(lambda: ("picture", 0, ("ideal", "ideal")) in told, "the ideal, begun again")


def test_what_fails_is_said_and_the_next_request_is_drawn(drawing, capsys):
    studio, lasting, told = drawing
    own = studio.machine

    def failing(view, stop=lambda: False):
        if view.upto == 1:
            raise Refusal("Not this one.")
        if view.upto == 2:
            raise KeyError("a fault")
        return own(view, stop)

    studio.machine = failing
    for serial in (1, 2):
        lasting.ask(Request(serial, replace(SPHERES, upto=serial)))
        until(lambda serial=serial: any(number == serial for _, number, _ in told))
    assert told[0] == ("failed", 1, "Not this one.")
    assert told[1][2].startswith("fixedpipe failed: KeyError.") and "a fault" in capsys.readouterr().err
    studio.go.release()
    lasting.ask(Request(3, SPHERES))
    until(lambda: told[-1][:2] == ("picture", 3))


# -------------------------------------------------------------------------------------------- conversation


class Window:
    """A window without a page: it keeps what it is told, and says that it has shown a picture if asked to."""

    def __init__(self, studio, shows=True):
        self.said, self.pictures, self.shows, self.bases = [], [], shows, {}
        self.talk = Conversation(studio, SPHERES, self.deliver)
        self.talk.greet()

    def deliver(self, message, data):
        if data is None:
            self.said.append(message)
        elif message["say"] == "kept":
            self.said.append(message | {"data": data})
        else:
            length = int.from_bytes(data[:4], "little")
            name = json.loads(data[8 : 8 + length])["name"]
            header, picture = decoded(data, self.bases.get(name))
            self.bases[name] = picture
            self.pictures.append((header, picture))
            if self.shows:
                self.show(header["number"])

    def show(self, number):
        self.talk.hear({"do": "shown", "number": number})

    def draw(self, serial, view=SPHERES, **more):
        self.talk.hear({"do": "draw", "number": serial, "view": to_object(view), **more})

    def drawn(self, serial, name="machine"):
        def found():
            ours = (p for h, p in tuple(self.pictures) if h["serial"] == serial and h["name"] == name)
            return next(ours, None)

        return until(found, f"picture {serial} of the {name}")


@pytest.fixture(scope="module")
def studio():
    return Studio(Subjects([FigureSubject(FIGURES["F004-4"])], figures=True))


@pytest.fixture
def window(studio):
    opened = []

    def open_one(**options):
        opened.append(Window(studio, **options))
        return opened[-1]

    yield open_one
    for one in opened:
        one.talk.close(wait=True)


def test_a_window_is_greeted_and_gets_what_it_asks_for(window, studio):
    one = window()
    hello = one.said[0]
    assert hello["say"] == "hello" and view_of(hello["start"]) == SPHERES
    assert {"F004-4", "F003-21"} <= set(hello["subjects"]) and "IDEAL" not in hello["machines"]
    one.draw(1, wants=["ideal"], other="NV2A")
    assert one.drawn(1).sha256 == studio.machine(SPHERES).sha256
    assert one.drawn(1, "other").sha256 == studio.machine(SPHERES.on("NV2A")).sha256
    assert one.drawn(1, "ideal").sha256 == studio.guided(SPHERES)[1].sha256
    numbers = until(lambda: [m for m in one.said if m["say"] == "numbers"])[0]["value"]
    assert numbers["shown"] == one.drawn(1).sha256


def test_a_window_that_does_not_keep_up_gets_the_newest_picture_next(window, studio):
    slow = window(shows=False)
    for serial in range(1, 9):
        slow.draw(serial, replace(SPHERES, upto=serial))
        until(
            lambda serial=serial: slow.talk._worker._drawn.serial == serial if slow.talk._worker._drawn else 0
        )
    assert [h["serial"] for h, _ in slow.pictures] == [1, 2][:IN_FLIGHT]
    slow.show(slow.pictures[0][0]["number"])
    newest = slow.drawn(8)
    assert [h["serial"] for h, _ in slow.pictures] == [1, 2, 8]
    assert newest.sha256 == studio.machine(replace(SPHERES, upto=8)).sha256
    assert slow.talk.counted["dropped"] >= 4


def test_a_window_that_lost_a_picture_gets_a_whole_one(window):
    one = window()
    one.draw(1)
    one.drawn(1)
    one.talk.hear({"do": "shown", "number": 99, "lost": True})
    one.draw(2, replace(SPHERES, upto=8))
    one.drawn(2)
    assert one.pictures[-1][0]["base"] is None


def test_a_slow_connection_gets_deflated_pictures(window, monkeypatch):
    monkeypatch.setattr(conversation, "_SLOW", 1e15)
    monkeypatch.setattr(conversation, "_FEW", 0)
    one = window()
    one.draw(1)
    one.drawn(1)
    one.draw(2, replace(SPHERES, upto=8))
    one.drawn(2)
    assert [h["deflated"] for h, _ in one.pictures] == [False, True]


HOSTILE = [
    None,
    [],
    "draw",
    {"do": "../../etc/passwd"},
    {"do": "__class__"},
    {"do": ["draw"], "number": {}},
    {"do": "draw", "number": 1, "view": None},
    {
        "do": "draw",
        "number": 1,
        "view": to_object(replace(SPHERES, id="<script>alert(1)</script>")),
        "wants": "x",
    },
    {"do": "draw", "number": 1, "view": to_object(SPHERES), "other": "C:\\NUL"},
    {"do": "history", "number": 2, "view": to_object(SPHERES), "at": ["1", 2]},
    {"do": "history", "number": 2, "view": to_object(SPHERES), "at": [10**30, -1]},
    {"do": "script", "number": 3, "view": to_object(replace(SPHERES, id="../x.py"))},
    {"do": "golden", "number": 4, "view": to_object(replace(SPHERES, machine="/dev/zero"))},
    {"do": "picture", "number": 5, "view": to_object(replace(SPHERES, values=(("map", "/etc/passwd"),)))},
    {"do": "about", "number": 6, "view": to_object(replace(SPHERES, id="F004-4\0"))},
]


@pytest.mark.parametrize("message", HOSTILE)
def test_hostile_messages_are_answered_by_a_sentence_and_do_no_harm(window, message, capfd):
    one = window()
    one.talk.hear(message)

    def refused():
        return next((m for m in tuple(one.said) if m["say"] in ("refused", "failed")), None)

    assert until(refused)["words"].endswith((".", "?"))
    one.draw(50)
    one.drawn(50)
    assert capfd.readouterr().err == ""
