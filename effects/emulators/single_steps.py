"""The rules' vectors in the form that SingleStepTests gave to tests of processors: one JSON list for each
rule.

A test has ``name``, ``initial``, ``final``, ``hash`` and ``idx``; metadata.json says what the files are.
Numbers are whole: those of single and double precision are their bits. There are no cycles: a rule is
computed in one step.

Source: README.md of the repositories SingleStepTests/8088 and SingleStepTests/65x02.
"""

import hashlib
import json
from typing import Any

from fixedpipe.effects.arithmetic.rule import Rule
from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.names import function_of

SYNTAX_VERSION = 1  # of this form
_BITS = {"single": 0x7FC00000, "double": 0x7FF8000000000000}  # of NaN


def _whole(kind: str, value: Any) -> Any:
    base, bracket, _ = kind.partition("[")
    if bracket:
        return [_whole(base, each) for each in value]
    if base == "bytes":
        return list(bytes.fromhex(value))
    if base not in _BITS:
        return value
    return _BITS[base] if value == "NaN" else int(value, 16)


def _said(value):
    return "[" + ", ".join(map(str, value)) + "]" if isinstance(value, list) else str(value)


def _test(rule, number, case):
    initial = {name: _whole(kind, case[name]) for name, kind in rule.inputs.items()}
    given = ", ".join(f"{name} {_said(case[name])}" for name in rule.inputs)
    test = {
        "name": f"{rule.id} {given}",
        "initial": initial,
        "final": {"result": _whole(rule.output, case["expected"])},
    }
    return test | {"hash": hashlib.sha1(json.dumps(test).encode()).hexdigest(), "idx": number}


def _file(rule: Rule, cases: int, seed: int) -> bytes:
    tests = (_test(rule, number, case) for number, case in enumerate(rule.cases(cases, seed)))
    return ("[\n" + ",\n".join(map(json.dumps, tests)) + "\n]\n").encode()


def single_step_files(cases: int, seed: int, version: str) -> dict[str, bytes]:
    """The files' contents by their names: v1/RULE.json with ``cases`` random tests behind the edges, from
    ``seed`` on, and metadata.json, which has each file's SHA-256 and ``version``, the package's.
    """
    files = {f"v1/{rule.id}.json": _file(rule, cases, seed) for rule in RULES.values()}
    metadata = {
        "version": version,
        "syntax_version": SYNTAX_VERSION,
        "chip": "NV2A",
        "generator": "fixedpipe golden export --rules --form singlestep",
        "seed": seed,
        "rules": {
            id_: {
                "function": function_of(id_),
                "status": rule.evidence.partition(":")[0].lower(),
                "evidence": rule.evidence,
                "captures": list(rule.captures),
                "inputs": dict(rule.inputs),
                "output": rule.output,
                "sha256": hashlib.sha256(files[f"v1/{id_}.json"]).hexdigest(),
            }
            for id_, rule in RULES.items()
        },
    }
    return files | {"metadata.json": (json.dumps(metadata, indent=1) + "\n").encode()}
