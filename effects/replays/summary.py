"""A summary of what happened to a trace's calls, in words and as data."""

from collections.abc import Iterator
from typing import Any

from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.opengl.outcomes import Outcome, Tally

# The kinds of a Tally in words, in the order in which a summary lists them.
KINDS = {
    "drawn": "drawn",
    "no effect": "of no effect here",
    "error": "ignored, as OpenGL ignores them",
    "lit here": "lit here, on the host",
    "refused": "refused",
    "left out": "left out, because OpenGL leaves them undefined",
    "unknown": "of functions that are unknown here",
}
# For these kinds a summary lists sentences, for the others names.
_SENTENCES = ("error", "refused", "left out", "lit here")
_MOST_NAMES, _MOST_SENTENCES = 8, 12


def is_refused(tally: Tally) -> bool:
    """Whether something was not carried out: a refusal, or a function that is unknown here."""
    return tally.count("refused") > 0 or tally.count("unknown") > 0


def summary_lines(tally: Tally) -> Iterator[str]:
    """Lines of text: for each kind its number, and names or sentences with their first calls. All sentences
    of refusals are listed.
    """
    for kind, words in KINDS.items():
        total = tally.count(kind)
        if not total:
            continue
        found = sorted(tally.of(kind), key=lambda outcome: -outcome.count)
        if kind in _SENTENCES:
            yield f"{words}: {total}"
            told = found if kind == "refused" else found[:_MOST_SENTENCES]
            for outcome in told:
                yield outcome_line(outcome)
            if len(found) > len(told):
                yield f"  and {count(len(found) - len(told), 'other sentence')}; --json has all"
            continue
        names = [f"{what} {times}" for what, _, times in found if times and not _is_sentence(what)]
        rest = len(names) - _MOST_NAMES
        more = f" and {count(rest, 'other')}" if rest > 0 else ""
        yield f"{words}: {total}" + f" ({', '.join(names[:_MOST_NAMES])}{more})" * bool(names)
        yield from (outcome_line(outcome) for outcome in found if _is_sentence(outcome.what))


def _is_sentence(what):
    """Whether an outcome says more than a function's name, such as what a machine lacks."""
    return ": " in what


def missing_features(tally: Tally) -> tuple[Outcome, ...]:
    """Features that a program uses and the machine lacks. This is no error: it draws without them."""
    return tuple([outcome for outcome in tally.of("no effect") if _is_sentence(outcome.what)])


def outcome_line(outcome: Outcome) -> str:
    """A line with a sentence, its first call, and how often it occurred."""
    often = f", {outcome.count} times in all" if outcome.count > 1 else ""
    return f"  call {outcome.first_call}{often}: {outcome.what}"


def summary_data(tally: Tally) -> dict[str, list[dict[str, Any]]]:
    """The summary as values for JSON."""
    return {
        kind: [
            {"what": what, "first_call": first, "count": times}
            for what, first, times in tally.of(kind)
            if times
        ]
        for kind in KINDS
    }
