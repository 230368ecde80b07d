"""The programs that tests hold as text: every string, or sum of strings, of a module that parses."""

import ast
from pathlib import Path

from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError

TESTS = Path(__file__).parents[1]
_HEADERS = ("!!RC1.0", "!!TS1.0", "ps.1.", "ps_1_", "SET_COMBINER_")


def programs_in_tests():
    """{text: Program} of the strings in tests/ that are programs."""
    found = {}
    for path in sorted(TESTS.rglob("*.py")):
        source = path.read_text()
        if any(header in source for header in _HEADERS):
            for text in _texts(ast.parse(source)):
                try:
                    found[text] = parse_program(text)
                except ProgramTextError:
                    continue
    return found


def _texts(module):
    """Strings with a header: constants, and sums of constants and of the module's names for such."""
    names = {}
    for statement in module.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name):
            names[statement.targets[0].id] = _folded(statement.value, names)
    texts = (_folded(node, names) for node in ast.walk(module) if isinstance(node, ast.expr))
    return {text for text in texts if text and any(header in text for header in _HEADERS)}


def _folded(node, names):
    """The string that an expression is, or None."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    if isinstance(node, ast.Name):
        return names.get(node.id)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        parts = _folded(node.left, names), _folded(node.right, names)
        return None if None in parts else "".join(parts)
    return None
