"""The GLSL of effects/emulators/sources, made from the C99 beside it: ``python -m tests.emulators.glsl``.

The C keeps to what both languages have: no pointers but arrays that a function receives, no structures, no
macros. Arrays of two to four numbers become vectors. Numbers of 64 bits become a uvec2, and their
operations calls of nv2a_uint64.glsl. Conversions that C makes by itself are written out.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from pycparser import c_ast, c_parser

from fixedpipe.effects.emulators.sources import FOLDER, STAGES

_TYPES = {"int": "int", "uint32_t": "uint", "uint64_t": "u64", "int64_t": "i64", "void": "void"}
_RANK = ("bool", "int", "uint", "i64", "u64")
_GLSL = {"int": "int", "uint": "uint", "u64": "uvec2", "i64": "uvec2", "void": "void", "bool": "bool"}
_CALLS = {"+": "add", "-": "subtract", "*": "multiply", "<<": "left", ">>": "right"}
_RESERVED_WORDS = (
    "active asm buffer cast class coherent common enum extern external filter fixed flat goto half "
    "highp image1D in inline inout input interface invariant layout long lowp mediump namespace "
    "noinline out output packed partition patch precise precision public resource restrict sample "
    "sampler2D shared short sizeof smooth subroutine superp template this typedef union uniform "
    "unsigned using varying volatile writeonly "
)
_RESERVED = set(_RESERVED_WORDS.split())
_ALSO_READ = "file"  # the one array that functions both read and write
_PRECEDENCE = ("||", "&&", "|", "^", "&", "== !=", "< > <= >=", "<< >>", "+ -", "* / %")
_LEVEL = {operator: k for k, level in enumerate(_PRECEDENCE) for operator in level.split()}
_UNARY, _ATOM = len(_PRECEDENCE), len(_PRECEDENCE) + 1


class Untranslatable(Exception):  # noqa: N818 (it names what happens)
    """What the C has and GLSL does not."""


@dataclass(frozen=True)
class Kind:
    """The type of a value: its base, and the extents of an array."""

    base: str
    extents: tuple[int, ...] = ()

    def of_element(self):
        """The type of what an index chooses."""
        return Kind(self.base, self.extents[1:])


@dataclass(frozen=True)
class Text:
    """An expression in GLSL, its type, and how tightly its outermost operator binds."""

    text: str
    kind: Kind
    level: int = _ATOM

    def within(self, level):
        """The text, in parentheses where an operator of that level binds more tightly."""
        return self.text if self.level >= level else f"({self.text})"


def _declared(kind, name):
    """A variable's declaration."""
    if name in _RESERVED:
        raise Untranslatable(f"GLSL keeps the word {name!r} for itself.")
    base = _GLSL[kind.base]
    if not kind.extents:
        return f"{base} {name}"
    *outer, last = kind.extents
    if kind.base in ("int", "uint") and 2 <= last <= 4:
        return f"{_vector(kind)} {name}" + "".join(f"[{n}]" for n in outer)
    return f"{base} {name}" + "".join(f"[{n}]" for n in kind.extents)


def _vector(kind):
    return f"{'i' if kind.base == 'int' else 'u'}vec{kind.extents[-1]}"


def _literal(text):
    digits = text.lower().rstrip("ul")
    value, suffix = int(digits, 0), text.lower()[len(digits) :]
    if suffix == "ull":
        return Text(f"uvec2(0x{value & 0xFFFFFFFF:x}u, 0x{value >> 32:x}u)", Kind("u64"))
    return Text(digits + suffix, Kind("uint" if suffix else "int"))


class _Function:
    """Translates one function's body."""

    def __init__(self, functions, constants):
        self.functions, self.names = functions, dict(constants)

    # ------------------------------------------------------------------------------------------- expressions

    def condition(self, node):
        found = self.expression(node)
        if found.kind.base == "bool":
            return found
        if found.kind.base in ("u64", "i64"):
            return Text(f"{found.within(_LEVEL['!='] + 1)} != uvec2(0u)", Kind("bool"), _LEVEL["!="])
        zero = "0u" if found.kind.base == "uint" else "0"
        return Text(f"{found.within(_LEVEL['!='] + 1)} != {zero}", Kind("bool"), _LEVEL["!="])

    def converted(self, found, base):
        """The expression as a value of another type, as C converts it."""
        have = found.kind.base
        if have == base or {have, base} == {"u64", "i64"} or found.kind.extents:
            return Text(found.text, Kind(base, found.kind.extents), found.level)
        wide = base in ("u64", "i64")
        if base == "bool":
            raise Untranslatable("a condition is wanted")
        if have in ("u64", "i64"):
            low = f"{found.within(_ATOM)}.x"
            return Text(low if base == "uint" else f"int({low})", Kind(base))
        if not wide:
            if have == "int" and base == "uint" and re.fullmatch(r"\d+", found.text):
                return Text(found.text + "u", Kind("uint"))
            return Text(f"{base}({found.text})", Kind(base))
        if have == "uint":
            return Text(f"uvec2({found.text}, 0u)", Kind(base))
        if re.fullmatch(r"\d+", found.text):
            return Text(f"uvec2({found.text}u, 0u)", Kind(base))
        whole = found.text if have == "int" else f"int({found.text})"
        return Text(f"nv2a_i64_of_int({whole})", Kind(base))

    def expression(self, node):
        return getattr(self, f"_{type(node).__name__.lower()}")(node)

    def _constant(self, node):
        return _literal(node.value)

    def _id(self, node):
        return Text(node.name, self.names[node.name])

    def _arrayref(self, node):
        array, index = self.expression(node.name), self.converted(self.expression(node.subscript), "int")
        return Text(f"{array.within(_ATOM)}[{index.text}]", array.kind.of_element())

    def _cast(self, node):
        wanted = _base(node.to_type.type)
        return self.converted(self.expression(node.expr), wanted)

    def _unaryop(self, node):
        if node.op == "!":
            return Text(f"!{self.condition(node.expr).within(_UNARY)}", Kind("bool"), _UNARY)
        found = self.expression(node.expr)
        if node.op in ("p++", "p--"):
            return Text(f"{found.text}{node.op[1:]}", found.kind)
        if found.kind.base == "bool":
            found = self.converted(found, "int")
        if node.op == "-" and found.kind.base in ("u64", "i64"):
            return Text(f"nv2a_u64_subtract(uvec2(0u), {found.text})", found.kind)
        return Text(f"{node.op}{found.within(_ATOM)}", found.kind, _UNARY)

    def _ternaryop(self, node):
        a, b = self.expression(node.iftrue), self.expression(node.iffalse)
        base = max(a.kind.base, b.kind.base, key=_RANK.index)
        a, b = self.converted(a, base), self.converted(b, base)
        return Text(f"{self.condition(node.cond).within(0)} ? {a.within(0)} : {b.text}", Kind(base), -1)

    def _binaryop(self, node):
        op = node.op
        if op in ("&&", "||"):
            a, b = self.condition(node.left), self.condition(node.right)
            plain = _LEVEL["=="]  # an && within an || has parentheses, for readers
            texts = [x.within(_LEVEL[op] if x.level == _LEVEL[op] else plain) for x in (a, b)]
            return Text(f" {op} ".join(texts), Kind("bool"), _LEVEL[op])
        a, b = self.expression(node.left), self.expression(node.right)
        if op in ("==", "!=") and a.kind.base == b.kind.base == "bool":
            return Text(f"{a.within(_LEVEL[op])} {op} {b.within(_LEVEL[op] + 1)}", Kind("bool"), _LEVEL[op])
        a, b = (self.converted(x, "int") if x.kind.base == "bool" else x for x in (a, b))
        if op in ("<<", ">>"):
            return self._shifted(a, op, self.converted(b, "int"))
        base = max(a.kind.base, b.kind.base, key=_RANK.index)
        if op == "*" and base == "u64" and all(isinstance(x, c_ast.Cast) for x in (node.left, node.right)):
            a, b = self.expression(node.left.expr), self.expression(node.right.expr)
            if a.kind.base == b.kind.base == "uint":  # of 32 bits each: a third of the steps
                return Text(f"nv2a_u32_product({a.text}, {b.text})", Kind(base))
            a, b = self.expression(node.left), self.expression(node.right)
        a, b = self.converted(a, base), self.converted(b, base)
        if base in ("u64", "i64"):
            return self._wide(a, op, b, base)
        kind = Kind("bool" if _LEVEL[op] in (_LEVEL["=="], _LEVEL["<"]) else base)
        return self._plain(a, op, b, kind)

    @staticmethod
    def _plain(a, op, b, kind):
        level = _LEVEL[op]
        mixed = op in ("|", "^", "&", "<<", ">>")  # written with parentheses, for readers
        left = a.within(_UNARY if mixed and a.level != level else level)
        return Text(f"{left} {op} {b.within(_UNARY if mixed else level + 1)}", kind, level)

    def _shifted(self, a, op, b):
        if a.kind.base not in ("u64", "i64"):
            return self._plain(a, op, b, a.kind)
        name = f"nv2a_{'i64' if op == '>>' and a.kind.base == 'i64' else 'u64'}_{_CALLS[op]}"
        return Text(f"{name}({a.text}, {b.text})", a.kind)

    def _wide(self, a, op, b, base):
        if op in _CALLS:
            return Text(f"nv2a_u64_{_CALLS[op]}({a.text}, {b.text})", Kind(base))
        if op in ("==", "!="):
            return self._plain(a, op, b, Kind("bool"))
        if op in ("&", "|", "^"):
            return self._plain(a, op, b, Kind(base))
        less = f"nv2a_{base}_less"
        if op in ("<", ">="):
            text = f"{less}({a.text}, {b.text})"
        elif op in (">", "<="):
            text = f"{less}({b.text}, {a.text})"
        else:
            raise Untranslatable(f"{op} of 64 bits")
        if op in ("<=", ">="):
            return Text(f"!{text}", Kind("bool"), _UNARY)
        return Text(text, Kind("bool"))

    def _funccall(self, node):
        name = node.name.name
        returned, parameters = self.functions[name]
        given = [] if node.args is None else node.args.exprs
        texts = []
        for kind, each in zip(parameters, given, strict=True):
            found = self.expression(each)
            if found.kind.extents != kind.extents:
                raise Untranslatable(f"{name} receives {found.kind}, and wants {kind}.")
            texts.append(self.converted(found, kind.base).text)
        return Text(f"{name}({', '.join(texts)})", returned)

    def _assignment(self, node):
        left = self.expression(node.lvalue)
        if node.op == "=":
            right = self.converted(self.expression(node.rvalue), left.kind.base)
            return Text(f"{left.text} = {right.text}", left.kind, -1)
        if left.kind.base in ("u64", "i64"):
            right = self._binaryop(c_ast.BinaryOp(node.op[:-1], node.lvalue, node.rvalue))
            return Text(f"{left.text} = {right.text}", left.kind, -1)
        right = self.expression(node.rvalue)
        right = self.converted(right, "int" if node.op in ("<<=", ">>=") else left.kind.base)
        return Text(f"{left.text} {node.op} {right.text}", left.kind, -1)

    # -------------------------------------------------------------------------------------------- statements

    def declaration(self, node):
        kind = _kind(node.type)
        self.names[node.name] = kind
        text = _declared(kind, node.name)
        if node.init is None:
            return text
        return f"{text} = {self.initial(node.init, kind)}"

    def initial(self, node, kind):
        """An initial value of that type."""
        if not isinstance(node, c_ast.InitList):
            return self.converted(self.expression(node), kind.base).text
        parts = ", ".join(self.initial(each, kind.of_element()) for each in node.exprs)
        if kind.base in ("int", "uint") and len(kind.extents) == 1 and 2 <= kind.extents[0] <= 4:
            return f"{_vector(kind)}({parts})"
        return f"{_GLSL[kind.base]}[{kind.extents[0]}]({parts})"

    def statement(self, node, returned, indent):
        """The lines of a statement."""
        pad = "    " * indent
        if isinstance(node, c_ast.Compound):
            return [
                line for each in node.block_items or () for line in self.statement(each, returned, indent)
            ]
        if isinstance(node, c_ast.Decl):
            return [f"{pad}{self.declaration(node)};"]
        if isinstance(node, c_ast.Return):
            if node.expr is None:
                return [f"{pad}return;"]
            return [f"{pad}return {self.converted(self.expression(node.expr), returned.base).text};"]
        if isinstance(node, c_ast.If):
            return self._branches(node, returned, indent)
        if isinstance(node, c_ast.For):
            begin = "; ".join(self.declaration(d) for d in node.init.decls)
            head = (
                f"{pad}for ({begin}; {self.condition(node.cond).text}; {self.expression(node.next).text}) {{"
            )
            return [head, *self.statement(node.stmt, returned, indent + 1), f"{pad}}}"]
        if isinstance(node, c_ast.Break):
            return [f"{pad}break;"]
        if isinstance(node, c_ast.Cast):  # (void)x: what a function does not read
            return []
        return [f"{pad}{self.expression(node).text};"]

    def _branches(self, node, returned, indent):
        pad = "    " * indent
        lines = [f"{pad}if ({self.condition(node.cond).text}) {{"]
        lines += self.statement(node.iftrue, returned, indent + 1)
        if isinstance(node.iffalse, c_ast.If):
            first, *rest = self._branches(node.iffalse, returned, indent)
            return [*lines, f"{pad}}} else {first.lstrip()}", *rest]
        if node.iffalse is not None:
            lines += [f"{pad}}} else {{", *self.statement(node.iffalse, returned, indent + 1)]
        return [*lines, f"{pad}}}"]


def _base(node):
    return _TYPES[node.type.names[-1]]


def _kind(node):
    extents = []
    while isinstance(node, c_ast.ArrayDecl):
        extents.append(int(node.dim.value))
        node = node.type
    return Kind(_base(node), tuple(extents))


def _writes(node, name):
    """Whether a body assigns to an array's elements."""
    if isinstance(node, c_ast.Assignment):
        target = node.lvalue
        while isinstance(target, c_ast.ArrayRef):
            target = target.name
        if target.name == name:
            return True
    return any(_writes(child, name) for _, child in node.children())


def _is_constant(node):
    while isinstance(node, c_ast.ArrayDecl):
        node = node.type
    return "const" in node.quals


class Translation:
    """All sources, in their order; each knows what those before it declare."""

    def __init__(self):
        self.functions, self.constants = {}, {}

    def of(self, text):
        """A source's GLSL."""
        comments = _comments(text)
        code = re.sub(r"/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S)
        code = re.sub(r"^#.*$", "", code, flags=re.M).replace("static inline", "")
        types = (
            "typedef unsigned int uint32_t; typedef unsigned long long uint64_t; typedef long long int64_t; "
        )
        parts = [comments.pop("head")]
        for node in c_parser.CParser().parse(types + code).ext:
            if isinstance(node, c_ast.Typedef):
                continue
            lines = comments.get(node.coord.line, []) + self.declared(node)
            parts.append("\n".join(lines))
        return "\n\n".join(parts) + "\n"

    def declared(self, node):
        """The lines of a function, a table or an enumeration."""
        translator = _Function(self.functions, self.constants)
        if isinstance(node, c_ast.FuncDef):
            return self.function(node, translator)
        if isinstance(node.type, c_ast.Enum):
            return [self.enumerator(e) for e in node.type.values.enumerators]
        text = translator.declaration(node)
        self.constants[node.name] = _kind(node.type)
        return _wrapped(f"const {text};")

    def enumerator(self, node):
        self.constants[node.name] = Kind("int")
        return f"const int {node.name} = {node.value.value};"

    def function(self, node, translator):
        kind, parameters = node.decl.type, []
        for parameter in kind.args.params:
            found = _kind(parameter.type)
            translator.names[parameter.name] = found
            way = "" if not found.extents or _is_constant(parameter.type) else "out "
            if parameter.name == _ALSO_READ:  # C99 cannot say of an array of arrays that it is read alone
                way = "inout " if _writes(node.body, parameter.name) else ""
            parameters.append((f"{way}{_declared(found, parameter.name)}", found))
        returned = _kind(kind.type)
        self.functions[node.decl.name] = (returned, [found for _, found in parameters])
        head = f"{_GLSL[returned.base]} {node.decl.name}({', '.join(text for text, _ in parameters)}) {{"
        body = [part for line in translator.statement(node.body, returned, 1) for part in _wrapped(line)]
        return [*_wrapped(head), *body, "}"]


def _wrapped(line, width=116):
    """A long line in several, cut before operators and behind commas."""
    inside = " " * (len(line) - len(line.lstrip()) + 4)
    lines = [line]
    while len(lines[-1]) > width:
        last = lines[-1]
        comma = last.rfind(", ", len(inside), width) + 1
        other = max(last.rfind(f" {sign} ", len(inside), width) for sign in ("||", "&&", "?", ":"))
        at = max(comma, other)
        lines[-1:] = [last[:at], inside + last[at:].lstrip()]
    return lines


def _comments(text):
    """What stands above a line, by that line's number, as GLSL's comments; ``head``: what the file says of
    itself.
    """
    found = {}
    for match in re.finditer(r"^/\*.*?\*/\n", text, flags=re.S | re.M):
        line = text.count("\n", 0, match.end()) + 1
        words = match[0].strip().removeprefix("/*").removesuffix("*/")
        lines = [
            f"// {each.strip().removeprefix('*').strip()}".rstrip() for each in words.strip().split("\n")
        ]
        if "head" not in found:
            found["head"] = "\n".join(lines)
        else:
            blank = text[match.end() :].startswith("\n")
            found[line + blank] = [*lines, ""] if blank else found.get(line, []) + lines
    return found


def translations():
    """The GLSL of every stage by its name, but for the one that is written by hand."""
    translation = Translation()
    return {stage: translation.of((FOLDER / f"nv2a_{stage}.h").read_text()) for stage in STAGES}


if __name__ == "__main__":
    for stage, text in translations().items():
        Path(FOLDER / f"nv2a_{stage}.glsl").write_text(text)
