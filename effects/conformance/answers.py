"""A real board's answers to the open questions: the output of docs/gl_questions.c, and which facts they
confirm.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from fixedpipe.effects.conformance.rules import RULES
from fixedpipe.effects.refusal import Refusal, no_such

MOST_CHARACTERS = 100_000  # of a file of some ten lines
_HEAD = re.compile(r"# gl_questions (\d+): (.*)")
_ANSWER = re.compile(r"([a-z-]+)(?: (\d{1,3})| not asked: (\S.*))")
_FORMAT = "1"


@dataclass(frozen=True)
class Question:
    """What gl_questions.c asks.

    ``stands``, ``otherwise``: in words. ``byte``, ``rivals``: what a board then draws.
    """

    text: str
    stands: str
    otherwise: str
    byte: int
    rivals: tuple[int, ...]


QUESTIONS: Mapping[str, Question] = {
    name: Question(rule.question, rule.stands, rule.otherwise, rule.probe.stands, rule.probe.otherwise)
    for name, rule in RULES.items()
    if rule.probe is not None
} | {
    "border-color": Question(
        "Does a texture's border colour pass through the texture's base format?",
        "through the base format, as OpenGL says (GEFORCE_256, GEFORCE_3)",
        "as it is given (NV2A)",
        51,
        (102,),
    )
}


@dataclass(frozen=True)
class Answer:
    """A board's answer: a byte, or None and why the board was not tested."""

    name: str
    byte: int | None
    why: str = ""

    @property
    def question(self) -> Question:
        """What was asked."""
        return QUESTIONS[self.name]

    @property
    def verdict(self) -> str:
        """Which it is: stands, otherwise, neither, or not asked."""
        if self.byte is None:
            return "not asked"
        if self.byte == self.question.byte:
            return "stands"
        return "otherwise" if self.byte in self.question.rivals else "neither"

    def sentence(self) -> str:
        """The verdict in words."""
        return {
            "stands": f"stands: {self.question.stands}",
            "otherwise": f"otherwise: {self.question.otherwise}; as it stands: {self.question.stands}",
            "neither": f"neither: {self.question.byte} as it stands, "
            f"{' or '.join(map(str, self.question.rivals))} otherwise",
            "not asked": f"not asked: {self.why}",
        }[self.verdict]


def read_answers(text: str, name: str) -> tuple[str, tuple[Answer, ...]]:
    """(the board, its answers) of gl_questions' output. ``name``: of the file, for sentences.

    Raises Refusal for a text that is no such output, and for a question that is none or answered twice.
    """
    lines = text[: MOST_CHARACTERS + 1].splitlines()
    head = _HEAD.fullmatch(lines[0]) if lines else None
    if head is None or len(text) > MOST_CHARACTERS:
        raise Refusal(f"{name} is no output of gl_questions; its first line is '# gl_questions 1: BOARD'.")
    if head[1] != _FORMAT:
        raise Refusal(f"{name} has format {head[1]} of gl_questions; this version reads format {_FORMAT}.")
    found: dict[str, Answer] = {}
    for number, line in enumerate(lines[1:], 2):
        if not line.strip():
            continue
        answer = _ANSWER.fullmatch(line.strip())
        if answer is None or (answer[2] and int(answer[2]) > 255):
            raise Refusal(f"{name}, line {number}, is no answer; give 'NAME BYTE' or 'NAME not asked: WHY'.")
        if answer[1] not in QUESTIONS:
            raise Refusal(f"{name}, line {number}: {no_such('question', answer[1], QUESTIONS)}")
        if answer[1] in found:
            raise Refusal(f"{name} answers {answer[1]} twice; leave one of the lines out.")
        found[answer[1]] = Answer(answer[1], int(answer[2]) if answer[2] else None, answer[3] or "")
    if not found:
        raise Refusal(f"{name} has no answers; run gl_questions again.")
    return head[2].strip(), tuple(found.values())
