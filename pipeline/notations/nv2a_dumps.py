"""The words of the NV2A's combiners in a text: a dump, a trace, or a program in C.

    NV097_SET_COMBINER_COLOR_ICW[1] = 0xc8c40000            by number
    0x97 -> NV097_SET_COMBINER_COLOR_ICW[1]<0xac4> (0xc8c40000 {...})
    0x97 -> 0x0ac4 NV097_SET_COMBINER_COLOR_ICW[4] 0xc8c40000          the address says which
    pb_push1(p, NV097_SET_COMBINER_COLOR_ICW + 1 * 4, 0xc8c40000);
    psd.PSRGBInputs[1] = PS_COMBINERINPUTS(PS_REGISTER_T0, PS_REGISTER_V0, 0, 0);
    SetRenderState(D3DRS_PSRGBINPUTS1, 0xc8c40000);

A name is followed by its index, its address, or both, then by nothing but blanks and ``= : ( , < > {``, and
then by its value. Any other form is refused, so that no number counts as a value that may be none.

Source: xemu's traces in its issues 786, 890, 1095 and 2530, nxdk's pbkit, Cxbx's dumps of pixel shaders.
"""

import re
from dataclasses import dataclass, field

from fixedpipe.pipeline.notations.nv2a_symbols import Expression, NoValue
from fixedpipe.pipeline.notations.tokens import ProgramTextError

# Methods: name, address, number of words, Direct3D's name.
METHODS = (
    ("SET_COMBINER_ALPHA_ICW", 0x0260, 8, "PSAlphaInputs"),
    ("SET_COMBINER_SPECULAR_FOG_CW0", 0x0288, 1, "PSFinalCombinerInputsABCD"),
    ("SET_COMBINER_SPECULAR_FOG_CW1", 0x028C, 1, "PSFinalCombinerInputsEFG"),
    ("SET_COMBINER_FACTOR0", 0x0A60, 8, "PSConstant0"),
    ("SET_COMBINER_FACTOR1", 0x0A80, 8, "PSConstant1"),
    ("SET_COMBINER_ALPHA_OCW", 0x0AA0, 8, "PSAlphaOutputs"),
    ("SET_COMBINER_COLOR_ICW", 0x0AC0, 8, "PSRGBInputs"),
    ("SET_SHADER_CLIP_PLANE_MODE", 0x17F8, 1, "PSCompareMode"),
    ("SET_SPECULAR_FOG_FACTOR", 0x1E20, 2, "PSFinalCombinerConstant"),
    ("SET_COMBINER_COLOR_OCW", 0x1E40, 8, "PSRGBOutputs"),
    ("SET_COMBINER_CONTROL", 0x1E60, 1, "PSCombinerCount"),
    ("SET_SHADER_STAGE_PROGRAM", 0x1E70, 1, "PSTextureModes"),
    ("SET_DOT_RGBMAPPING", 0x1E74, 1, "PSDotMapping"),
    ("SET_SHADER_OTHER_STAGE_INPUT", 0x1E78, 1, "PSInputTexture"),
)
COUNTS = {name: count for name, _, count, _ in METHODS}
_BEGIN_END = "SET_BEGIN_END"
_ALL = (*METHODS, (_BEGIN_END, 0x17FC, 1, _BEGIN_END))
_ADDRESSES = {address + 4 * k: (name, k) for name, address, count, _ in _ALL for k in range(count)}
_NAMES = {alias.upper(): name for name, _, _, word in _ALL for alias in (name, word)}
# The spelling in dumps of Cxbx and related emulators.
_NAMES["PSAPHAINPUTS"] = "SET_COMBINER_ALPHA_ICW"
_WORDS_OF = COUNTS | {_BEGIN_END: 1}

_COMMENT = re.compile(r"(?<!:)//[^\n]*|/\*.*?\*/", re.DOTALL)
_LINE_COMMENT = re.compile(r"(?<!:)//[^\n]*")
# Lines without words: comments of other notations, preprocessor directives, and calls that clear words.
_PASSED = re.compile(r"[ \t]*(?:[#;]|(?:memset[ \t]*\([^,\n]*,[ \t]*0|ZeroMemory[ \t]*\([^,\n]*)[ \t]*,)")
_TERM = re.compile(r"[A-Za-z_]\w*|0[xX](?P<hex>[0-9a-fA-F]+)\b")
_PREFIX = re.compile(r"(?:X_)?(?:D3DRS_)?(?:NV097_)?")
_OTHER_METHOD = re.compile(r"NV[0-9A-Fa-f]{3}_|(?:X_)?D3DRS_|SET_[A-Z0-9]")
# The class in a trace's line: other classes have methods at the same addresses.
_CLASS, _KELVIN = re.compile(r"0[xX]0*(?P<hex>[0-9a-fA-F]{1,2})>?[ \t]*->"), 0x97
_NUMBER = r"(?P<index>0[xX][0-9a-fA-F]{1,2}|[0-9]+)"
_INDEX = re.compile(rf"[ \t]*(?:(?P<open>[\[(<])[ \t]*{_NUMBER}[ \t]*[\])>])?")
_NO_INDEX = re.compile(r"\[(?P<index>[^\]\n]*)")
_ADDRESS_BEFORE = re.compile(r"0[xX]0*(?P<hex>[0-9a-fA-F]{3,4})[ \t:(<]*\Z")
_SUM_BEFORE = re.compile(r"[\w)\]][ \t]*([+*/&|^-])[ \t]*\(?\Z")
_PLUS, _AFTER_OFFSET = re.compile(r"[ \t]*\+(?!=)"), re.compile(r"[ \t]*[,\])=:]")
# An address beside a name: in brackets, or before another number.
_ADDRESS = re.compile(
    r"[ \t]*(?:(?P<open>[(<])[ \t]*)?0[xX]0*(?P<hex>[0-9a-fA-F]{1,4})"
    r"(?(open)[ \t]*[)>]|(?=[ \t]+[(<{]*[0-9]))"
)
_NAME_BESIDE = re.compile(r"[ \t]*[(<]?[ \t]*(?P<name>[A-Za-z_]\w*)")
_BETWEEN = re.compile(r"""[ \t]*[\])]?(?:->|=>|[ \t=:(,<>{"'])*""")
_GOES_ON, _LINE_END = re.compile(r"[=:,({]"), re.compile(r"[ \t]*(?:\n|\Z)")
_OPENS = re.compile(r"[ \t]*\(")
_OPENED, _GOES_ON_BEHIND = re.compile(r"(?:\([( \t]*)?\Z"), re.compile(r"[ \t]*\)[) \t]*(?:[|^&+*]|<<)")
_NEXT, _NEXT_LISTED = re.compile(r"[ \t,]+"), re.compile(r"[ \t,\n]+")
_BEGINS_VALUE = re.compile(r"[0-9]|PS_[A-Z]+_|PS_COMBINER|D3DCOLOR_")
# Calls that take a number of words or bytes instead of the first word.
_COUNTING = re.compile(
    r"\b(?P<name>\w*(?:METHOD|BEGIN|HEADER)\w*|pb_push(?:_to)?|mem\w+)[ \t]*\((?P<rest>[^\n]*)", re.IGNORECASE
)
# Assumed: no call is longer before a method's name.
_CALL = 400
_PUSHED = re.compile(r"\n\s*(?:\*\s*\(?\s*\w+\s*\+\+|OUT_RING\w*\s*\(|\w*PUSH_?DATA\w*\s*\()", re.IGNORECASE)
_ENDS = re.compile(r"\w*END\b")
_LARGEST = 0xFFFFFFFF


class RegisterTextError(ProgramTextError):
    """A text without words of the NV2A's combiners, or with words that no program has."""


@dataclass
class Dump:
    """The words of a text.

    - ``words``: {(name, index): word}.
    - ``lines``: {(name, index): line}.
    - ``notes``: sentences.
    """

    words: dict
    lines: dict
    notes: list = field(default_factory=list)


def is_dump(text: str) -> bool:
    """Whether a text without a header names one of the methods."""
    reader = _Reader(text, (1, 1))
    return any(found and found[0] != _BEGIN_END for found in map(reader.method, reader.line_starts()))


def read_dump(text: str, start=(1, 1), draw: int | None = None) -> Dump:
    """The Dump of a text before its draw of this number, from 1; without a number, before the last draw.

    A draw is a SET_BEGIN_END that begins one. Raises RegisterTextError with line and column.
    """
    reader = _Reader(text, start)
    reader.read()
    return reader.dump(draw)


def _named(word):
    """(name of a method, index or None) for a name from a dump or a program, or None."""
    name = word[_PREFIX.match(word).end() :].upper()
    if name in _NAMES:
        return _NAMES[name], None
    for digits in (1, 2):
        begin, last = name[:-digits], name[-digits:]
        begin = begin.removesuffix("_")
        if last.isdecimal() and begin in _NAMES and (_WORDS_OF[_NAMES[begin]] > 1 or last == "0"):
            return _NAMES[begin], int(last)
    return None


def _blanks(found):
    return re.sub(r"[^\n]", " ", found[0])


class _Reader:
    def __init__(self, text, start):
        # Blanks replace comments, so that places stay.
        closed = text.rfind("*/") + 2 if "*/" in text else 0
        self.text = _COMMENT.sub(_blanks, text[:closed]) + _LINE_COMMENT.sub(_blanks, text[closed:])
        self.start = start
        self.words: dict = {}
        self.lines: dict = {}
        # (words, lines, registers given again) before each draw; the same object where nothing changed.
        self.draws: list = []
        self.changed = True
        self.again: set = set()
        self.bracketed: dict = {}

    def error(self, at, sentence):
        number = self.text.count("\n", 0, at) + self.start[0]
        return RegisterTextError(sentence, number, at - self.text.rfind("\n", 0, at))

    def line_starts(self):
        at = 0
        while at <= len(self.text):
            yield at
            at = self.line_end(at) + 1

    def line_end(self, at):
        end = self.text.find("\n", at)
        return len(self.text) if end < 0 else end

    def read(self):
        at, number, begins = 0, self.start[0], True
        while at <= len(self.text):
            found = self.method(at, begins)
            end = self.line_end(at) + 1 if found is None else self.statement(*found, number)
            number += self.text.count("\n", at, end)
            at, begins = end, found is None
        self.refuse_offsets()

    def method(self, at, begins=True):
        """(name, index or None, its end, whether it is an address) of the line's first method, or None.

        The search starts at ``at``. ``begins`` says that the line begins there; addresses stand at its
        beginning.
        """
        if begins and _PASSED.match(self.text, at):
            return None
        first = begins
        for term in _TERM.finditer(self.text, at, self.line_end(at)):
            if term["hex"] is None:
                if known := _named(term[0]):
                    return self.behind_address(at, term, *known)
                # An argument of another method is no address.
                first = first and not _OTHER_METHOD.match(term[0])
                continue
            value = int(term["hex"][-8:], 16)
            if trace := _CLASS.match(self.text, term.start()):
                if int(trace["hex"], 16) != _KELVIN:
                    return None
                first = begins
                continue
            if first and len(term["hex"]) in (3, 4) and value in _ADDRESSES:
                return (*_ADDRESSES[value], term.end(), True)
            first = first and value == _KELVIN
        return None

    def behind_address(self, line, term, name, index):
        """The result of ``method`` for a name; its address may stand before it."""
        before = _ADDRESS_BEFORE.search(self.text, line, term.start())
        if before and _ADDRESSES.get(int(before["hex"], 16), ("",))[0] == name:
            return (*_ADDRESSES[int(before["hex"], 16)], before.end("hex"), True)
        if sum_ := _SUM_BEFORE.search(self.text, line, term.start()):
            raise self.error(
                sum_.end(1),
                f"{name} follows {sum_[1]}; write the offset of a word after the name.",
            )
        return name, index, term.end(), False

    def statement(self, name, index, at, is_address, number):
        """Read the values after a method; returns where they end."""
        begin = at
        if is_address:
            index, at, bracket = *self.name_beside(name, index, at), None
        else:
            index, at, bracket = self.index(name, index, at)
        if name == _BEGIN_END:
            return self.begin_or_end(at)
        self.refuse_counts(name, begin)
        values, end, listed = self.values(name, at, bracket)
        if bracket and (
            (index == COUNTS[name] and (listed or len(values) == index))
            or values[0][1] == bracket.start("index")
        ):
            index = 0  # NAME[8] = eight values, as in the array's declaration; or NAME (value)
        if len(values) == 1 and self.is_address(name, index, at, values[0]):
            raise self.error(at, f"{name} has its address and no value; write {name} = 0x0 for instance.")
        for k, (value, where) in enumerate(values, index):
            if not 0 <= value <= _LARGEST:
                given = re.compile(r"[^\s,;)}]{1,20}").match(self.text, where)[0]
                raise self.error(where, f"{name} is given {given}, which is no word of 32 bits; give one.")
            if k >= COUNTS[name]:
                raise self.error(
                    at,
                    f"{name} has the words 0 to {COUNTS[name] - 1}; word {k} is given. Give those, or the "
                    "method's address.",
                )
            key = name, k
            if self.words.get(key, value) != value:
                self.again.add(key)
            self.changed = self.changed or self.words.get(key) != value
            self.words[key], self.lines[key] = value, number
        return end

    def name_beside(self, name, index, at):
        """(index, where the value may begin) for an address, which its own name may follow."""
        beside = _NAME_BESIDE.match(self.text, at)
        known = beside and _named(beside["name"])
        if not known:
            return index, at
        if known[0] != name or known[1] not in (None, index):
            raise self.error(
                beside.start("name"),
                f"{beside['name'][:60]} follows the address of {name}, word {index}; give one of them.",
            )
        at = beside.end()
        bracket = _INDEX.match(self.text, at)
        if bracket["open"]:
            self.agree(name, index, bracket)
            at = bracket.end()
        return index, at

    def agree(self, name, index, bracket):
        """Refuse an index beside an address that is neither the word's nor its offset in bytes."""
        given = _number(bracket["index"])
        if given not in (index, 4 * index) and (bracket["open"] == "[" or given < COUNTS[name]):
            raise self.error(
                bracket.start("index"),
                f"{name} has the index {given} beside the address of word {index}; give one of them.",
            )

    def index(self, name, index, at):
        """(index, where the value may begin, the bracket with the index or None) for a name."""
        text, bracket = self.text, _INDEX.match(self.text, at)
        if bracket["open"] and index is None and not self.is_own_address(name, bracket):
            index, at = _number(bracket["index"]), bracket.end()
        else:
            bracket, at = None, bracket.end() if not bracket["open"] else at
            if index is None and (wrong := _NO_INDEX.match(text, at)) is not None:
                raise self.error(
                    wrong.start("index"),
                    f"{name} has the index {wrong['index'][:40]!r}, which is no number; give one.",
                )
        if (plus := _PLUS.match(text, at)) is not None:
            index, at = self.offset(name, index or 0, plus)
        address = _ADDRESS.match(text, at)
        found = address and _ADDRESSES.get(int(address["hex"], 16))
        if found and found[0] == name:
            if bracket:
                self.agree(name, found[1], bracket)
            return found[1], address.end(), None
        if found and address["open"] == "<":
            raise self.error(
                address.start("hex"),
                f"{name} is followed by the address of {found[0]}, word {found[1]}; give one of them.",
            )
        if bracket and bracket["open"] == "[":
            self.bracketed.setdefault(name, {})[index] = bracket.start("index")
        return index or 0, at, bracket

    def is_own_address(self, name, bracket):
        return bracket["open"] != "[" and _ADDRESSES.get(_number(bracket["index"]), ("",))[0] == name

    def offset(self, name, index, plus):
        """(index, its end) for a name that is followed by + and an offset in bytes."""
        try:
            given = Expression(self.text, plus.end())
        except NoValue as none:
            raise self.error(
                none.at, f"{name} is followed by + and {none.found}; give the number of its word."
            ) from none
        if given.value < 0 or given.value % 4 or not _AFTER_OFFSET.match(self.text, given.end):
            raise self.error(
                plus.end(),
                f"{name} is followed by + and no offset of a word; give a multiple of 4 bytes.",
            )
        return index + given.value // 4, given.end

    def refuse_counts(self, name, at):
        """Refuse a push buffer's header, which says how many words follow elsewhere, and a memory block."""
        before = max(self.text.rfind("\n", 0, at) + 1, at - _CALL)
        counting = _COUNTING.search(self.text, before, at)
        if counting and counting["rest"].count(")") > counting["rest"].count("("):
            counting = None
        if counting or _PUSHED.match(self.text, self.line_end(at)):
            who = counting["name"][:40] if counting else "this line"
            raise self.error(
                at,
                f"{who} takes a number of words or bytes beside {name}, not its value, and what follows is "
                f"not read; write {name} = 0x0 for instance.",
            )

    def is_address(self, name, index, at, value):
        """Whether the only number after a name is its own address, as in lists of methods."""
        number, where = value
        return _ADDRESSES.get(number) == (name, index) and not re.search(r"[=,]|->", self.text[at:where])

    def values(self, name, at, bracket):
        """([(value, its place)], at least one; where they end; whether they are a list in braces)."""
        text, place = self.text, at
        between = _BETWEEN.match(text, at)
        listed, at = "{" in between[0], between.end()
        if _LINE_END.match(text, at) and _GOES_ON.search(between[0]):
            line = self.line_end(at) + 1
            other = not _OPENS.match(text, line) and self.method(line)
            if line < len(text) and not _PASSED.match(text, line) and not other:
                between = _BETWEEN.match(text, line)
                listed, at = listed or "{" in between[0], between.end()
        if at >= len(text) or text[at] in "\n;)]}" or (text[at] == "~" and not _GOES_ON.search(between[0])):
            if bracket and bracket["open"] != "[" and COUNTS[name] == 1:
                return [(_number(bracket["index"]), bracket.start("index"))], at, False
            raise self.error(place, f"{name} has no value; write {name} = 0x0 for instance.")
        found = []
        while True:
            value = self.expression(name, at, 0 if found else len(_OPENED.search(between[0])[0]))
            found.append((value.value, at))
            following = (_NEXT_LISTED if listed else _NEXT).match(text, value.end)
            if following is None or not _BEGINS_VALUE.match(text, following.end()):
                return found, value.end, listed
            at = following.end()

    def expression(self, name, at, opened):
        """The Expression at ``at``, or from the first of ``opened`` parentheses and blanks before it."""
        text = self.text
        if opened:
            try:
                return Expression(text, at - opened)
            except NoValue:  # The parenthesis is the trace's own and holds more than the value.
                pass
        try:
            value = Expression(text, at)
            if opened and (more := _GOES_ON_BEHIND.match(text, value.end)):
                raise NoValue(more.start(), "an expression that is not closed")
        except NoValue as none:
            raise self.error(
                none.at,
                f"{name} is followed by {none.found}, where its value belongs; write {name} = 0x0 for "
                "instance.",
            ) from none
        return value

    def begin_or_end(self, at):
        at = _BETWEEN.match(self.text, at).end()
        try:
            begins = Expression(self.text, at).value != 0
        except NoValue:  # It is a name: TRIANGLES, NV097_SET_BEGIN_END_OP_END.
            begins = not _ENDS.match(self.text, at)
        if begins:
            if self.changed or not self.draws:
                self.draws.append((dict(self.words), dict(self.lines), len(self.again)))
            else:
                self.draws.append(self.draws[-1])
            self.changed = False
        return at

    def refuse_offsets(self):
        """Refuse brackets that look like offsets in bytes where no address confirms them."""
        for name, given in self.bracketed.items():
            if given.keys() == {0, 4} and name.endswith("CW"):
                raise self.error(
                    given[4],
                    f"{name} has words 0 and 4 and none between them: brackets may be words, or offsets in "
                    "bytes. Write the methods' addresses beside them.",
                )

    def dump(self, draw):
        count, notes = len(self.draws), []
        if draw is not None and not 1 <= draw <= count:
            there = f"draws 1 to {count}" if count else "no draw (no SET_BEGIN_END that begins one)"
            raise self.error(0, f"the text has {there}; draw {draw} is asked for. Give one of them.")
        words, lines, again = self.words, self.lines, len(self.again)
        if count and (draw is not None or self.draws[-1][0]):
            words, lines, again = self.draws[(draw or count) - 1]
        if count > 1:
            same = all(other[0] == words for other in self.draws)
            taken = "all have the same words" if same else f"the words before draw {draw or count} are taken"
            more = "" if same or draw is not None else "; give the number of another to have its words"
            notes.append(f"the text has {count} draws (SET_BEGIN_END): {taken}{more}.")
        elif again:
            are = "register is" if again == 1 else "registers are"
            notes.append(f"{again} {are} given more than once, with other values: the last stays.")
        if draw is None and words is not self.words and self.words != words:
            notes.append("words behind the last draw are left out.")
        return Dump(words, lines, notes)


def _number(text):
    return int(text[:9], 16 if text[:2] in ("0x", "0X") else 10)
