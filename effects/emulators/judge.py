"""Judges another program: sends it the rules' vectors, a line each, and counts its correct answers.

A program is a process of its own for each rule, so that one that crashes or hangs loses one rule. Its output
is read a line at a time. Only that line and the end of its error messages stay in memory.
"""

import contextlib
import json
import os
import queue
import signal
import subprocess
import threading
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.arithmetic.rule import Rule
from fixedpipe.effects.emulators.names import function_of
from fixedpipe.effects.refusal import Refusal

LONGEST = 1 << 16  # bytes of an answer's line
_WAITING = 256  # lines that are read before they are looked at
_COMPLAINT = 200  # characters of what a program wrote on its error stream
_ENDED = object()


@dataclass(frozen=True)
class Score:
    """How a program did on one rule.

    right, vectors   how many of how many
    first            the first difference: case, inputs, expected, answered; None where there is none
    failure          a sentence if the program did not reach the rule's end; otherwise empty
    absent           it answered null always: it has no such rule
    """

    rule: Rule
    right: int
    vectors: int
    first: dict[str, Any] | None = None
    failure: str = ""
    absent: bool = False

    @property
    def whole(self) -> bool:
        """Whether everything is right."""
        return not self.failure and self.right == self.vectors

    def record(self) -> dict[str, Any]:
        """The score as a JSON object."""
        rule = self.rule
        return {
            "rule": rule.id,
            "stage": rule.stage,
            "numbers": rule.numbers,
            "function": function_of(rule.id),
            "evidence": rule.evidence,
            "tag": tag_of(rule),
            "captures": list(rule.captures),
            "open": rule.open,
            "right": self.right,
            "vectors": self.vectors,
            "absent": self.absent,
            "first": self.first,
            "failure": self.failure,
        }


def tag_of(rule: Rule) -> str:
    """The evidence's first word: Measured, Inferred, Source or Assumed."""
    return rule.evidence.partition(":")[0]


# ---------------------------------------------------------------------------------------------------- values


def _same_number(base, expected, answered):
    digits = {"single": 8, "double": 16}[base]
    if isinstance(answered, str):
        if answered == "NaN":
            return expected == "NaN"
        try:
            answered = int(answered, 16)
        except ValueError:
            return False
    if not _is_whole(answered) or not 0 <= answered < 16**digits:
        return False
    if expected == "NaN":
        infinity, sign = (0x7F800000, 1 << 31) if base == "single" else (0x7FF << 52, 1 << 63)
        return answered & (sign - 1) > infinity
    return int(expected, 16) == answered


def _is_whole(value):
    return type(value) is int  # True is none


def same(kind: str, expected: Any, answered: Any) -> bool:
    """Whether an answer is what a vector expects. Bits are a string of hexadecimal digits, or a number."""
    base, bracket, _ = kind.partition("[")
    if bracket:
        alike = type(answered) is list and len(answered) == len(expected)
        return alike and all(same(base, *pair) for pair in zip(expected, answered, strict=True))
    if base in ("single", "double"):
        return _same_number(base, expected, answered)
    if base == "int":
        return _is_whole(answered) and answered == expected
    return type(answered) is str and answered.lower() == expected


# ------------------------------------------------------------------------------------------------ the process


class _Gone(Exception):  # noqa: N818 (it names what happens)
    """The program does not go on; the message is the rest of a sentence that begins with "It"."""


class _Asked:
    """The program, asked a rule's cases."""

    def __init__(self, command, lines, patience):
        self.patience = patience
        self.answers: queue.Queue[Any] = queue.Queue(_WAITING)
        self.complaint, self.moved = b"", threading.Event()
        try:
            self.process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,
            )
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise Refusal(
                f"{command[0]!r} cannot be started: {reason}. Give the path of a program that runs here."
            ) from error
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        for target, arguments in ((self._write, (lines,)), (self._read, ())):
            threading.Thread(target=target, args=arguments, daemon=True).start()

    def _write(self, lines):
        with contextlib.suppress(OSError, ValueError):  # it has ended, or is ended
            for line in lines:
                self.process.stdin.write(line)
                self.process.stdin.flush()
                self.moved.set()
            self.process.stdin.close()

    def _read(self):
        with contextlib.suppress(OSError, ValueError):
            while line := self.process.stdout.readline(LONGEST + 1):
                self.answers.put(line)
                if len(line) > LONGEST:
                    break
        self.answers.put(_ENDED)

    def _listen(self):
        with contextlib.suppress(OSError, ValueError):
            while text := self.process.stderr.read1(4096):
                self.complaint = (self.complaint + text)[-4 * _COMPLAINT :]

    def answer(self, case):
        """The next line, bytes. Raises _Gone where none comes."""
        while True:
            self.moved.clear()
            try:
                line = self.answers.get(timeout=self.patience)
                break
            except queue.Empty:
                if not self.moved.is_set():  # it took no question either
                    raise _Gone(
                        f"hangs: no answer to case {case} came within {self.patience:g} seconds."
                    ) from None
        if line is _ENDED:
            raise _Gone(self._how_it_ended(case))
        if len(line) > LONGEST:
            raise _Gone(f"answers case {case} with a line of more than {LONGEST} bytes.")
        return line

    def _how_it_ended(self, case):
        try:
            status = self.process.wait(self.patience)
        except subprocess.TimeoutExpired:
            return f"closed its output before case {case}, and goes on."
        ended = f"ended with status {status}"
        if status < 0:
            ended = f"crashed with signal {-status} ({signal.strsignal(-status)})"
        self._listener.join(self.patience)  # what it started may still hold its errors open
        said = self.complaint.decode(errors="replace").strip().splitlines()
        last = "".join(c for c in said[-1] if c.isprintable())[:_COMPLAINT] if said else ""
        return f"{ended} before case {case}" + (f", and said: {last}" if last else ".")

    def close(self):
        """End the program, and what it started."""
        with contextlib.suppress(OSError):
            os.killpg(self.process.pid, signal.SIGKILL)
        with contextlib.suppress(queue.Empty):
            while True:  # the reader may wait for room
                self.answers.get_nowait()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            with contextlib.suppress(OSError, ValueError):
                stream.close()


def question(rule: Rule, number: int, case: dict[str, Any]) -> bytes:
    """The line that requests a case."""
    inputs = {name: case[name] for name in rule.inputs}
    return json.dumps({"rule": rule.id, "case": number, "inputs": inputs}).encode() + b"\n"


def _result_of(line, number):
    try:
        answer = json.loads(line)
    except (ValueError, RecursionError):
        shown = line[:40].decode(errors="replace").strip()
        raise _Gone(f"answers case {number} with what is no JSON: {shown!r}.") from None
    if type(answer) is not dict or "result" not in answer:
        raise _Gone(f'answers case {number} without a "result".')
    if answer.get("case", number) != number:
        raise _Gone(
            f"answers case {number} with case {answer['case']!r}; answers keep the order of the questions."
        )
    return answer["result"]


def judge_rule(command: Sequence[str], rule: Rule, cases: int, seed: int, patience: float) -> Score:
    """How a program does on a rule's edges and ``cases`` random cases.

    Raises Refusal for a program that cannot be started.
    """
    known = list(rule.cases(cases, seed))
    asked = _Asked(command, (question(rule, k, case) for k, case in enumerate(known)), patience)
    right, nothing, first, failure = 0, 0, None, ""
    try:
        for number, case in enumerate(known):
            answered = _result_of(asked.answer(number), number)
            good = same(rule.output, case["expected"], answered)
            right, nothing = right + good, nothing + (answered is None)
            if not good and first is None:
                inputs = {name: case[name] for name in rule.inputs}
                first = {"case": number, "inputs": inputs, "expected": case["expected"], "answered": answered}
    except _Gone as gone:
        failure = f"It {gone}"
    finally:
        asked.close()
    absent = bool(known) and nothing == len(known)
    return Score(rule, right, len(known), None if absent else first, failure, absent)


def judged(
    command: Sequence[str], rules: Iterable[Rule], cases: int, seed: int, patience: float
) -> Iterable[Score]:
    """The scores, one rule after the other."""
    for rule in rules:
        yield judge_rule(command, rule, cases, seed, patience)


def totals(scores: Sequence[Score]) -> dict[str, Any]:
    """Rules that are all correct and all rules, by evidence; vectors; and rules that the program lacks or
    fails.
    """
    tags = sorted({tag_of(score.rule) for score in scores})
    by_tag = {tag: [score for score in scores if tag_of(score.rule) == tag] for tag in tags}
    return {
        "rules": len(scores),
        "whole": sum(score.whole for score in scores),
        "vectors": sum(score.vectors for score in scores),
        "right": sum(score.right for score in scores),
        "absent": sum(score.absent for score in scores),
        "failed": sum(bool(score.failure) for score in scores),
        "by_evidence": {
            tag: {"rules": len(of), "whole": sum(score.whole for score in of)} for tag, of in by_tag.items()
        },
    }
