"""How golden pictures went, for other programs: JSON, and JUnit's XML."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from fixedpipe.pipeline.golden.candidates import (
    ALLOWED,
    CHANGED,
    EXCUSED,
    FOLDER,
    MISSING,
    NEW,
    ORPHAN,
    PASSED,
    RECORDED,
    candidate_files,
    compared,
    read_candidates,
    read_run,
)
from fixedpipe.pipeline.golden.differences import Difference
from fixedpipe.pipeline.golden.store import StoreError, read_store

# From what needs a person first to what needs nobody.
STATUSES = (CHANGED, NEW, MISSING, ORPHAN, ALLOWED, RECORDED, EXCUSED, PASSED)
GOOD = (PASSED, ALLOWED, RECORDED, EXCUSED)
_SAID = {
    NEW: "has no golden picture yet",
    MISSING: "its test did not draw it",
    ORPHAN: "is golden, and no test asks for it",
    EXCUSED: "its test was skipped, or failed as it was expected to",
}

# Of a picture that has no candidate.
_NOTHING_WAITS = {
    NEW: "was accepted since this run; run pytest again",
    CHANGED: "was accepted since this run, or must differ from its golden picture; run pytest again",
}


def results(root: Path) -> list[dict[str, Any]]:
    """Every picture of the last run, those that need a person first, the largest difference at the top: name,
    status, store, test, told and, where pixels differ, difference. Raises StoreError.
    """
    candidates, found = read_candidates(root), []
    for name, picture in read_run(root)["pictures"].items():
        entry = {"name": name, "told": _SAID.get(picture["status"], ""), **picture, "difference": None}
        if picture["status"] == MISSING:
            entry["told"] = _unreadable(root / picture["store"]) or entry["told"]
        candidate = candidates.get(name)
        if candidate is not None and picture["status"] in (CHANGED, NEW):
            entry["told"] = candidate.told or entry["told"]
            try:
                what = compared(root, candidate)
            except StoreError as error:  # a damaged file of one picture; the others are told all the same
                what = str(error)
                entry["told"] += f"\n{error}" if what not in entry["told"] else ""
            if isinstance(what, Difference):
                entry["difference"] = asdict(what)
        elif picture["status"] in (CHANGED, NEW):
            entry["told"] = _NOTHING_WAITS[picture["status"]]
        found.append(entry)
    return sorted(found, key=_order)


def _unreadable(store):
    """Why a store cannot be read; empty where it can."""
    try:
        read_store(store)
    except StoreError as error:
        return str(error)
    return ""


def _order(entry):
    apart = entry["difference"]
    size = (-apart["largest"], -apart["count"]) if apart else (0, 0)
    return STATUSES.index(entry["status"]), size, entry["name"]


def results_json(root: Path, found: list[dict[str, Any]], written: list[str]) -> str:
    """Results and the paths of all that was written, as JSON text."""
    kept = [path.as_posix() for path in candidate_files(root)]
    files = [*written, f"{FOLDER}/run.json", *kept]
    return json.dumps({"format": 1, "pictures": found, "written": files}, ensure_ascii=False, indent=1) + "\n"


def results_junit(found: list[dict[str, Any]]) -> bytes:
    """Results as JUnit's XML: a suite for each store, a case for each picture."""
    top = ElementTree.Element("testsuites", name="golden pictures")
    for store in sorted({entry["store"] for entry in found}):
        cases = [entry for entry in found if entry["store"] == store]
        failed = [entry for entry in cases if entry["status"] not in GOOD]
        suite = ElementTree.SubElement(
            top, "testsuite", name=store, tests=str(len(cases)), failures=str(len(failed)), errors="0"
        )
        for entry in cases:
            case = ElementTree.SubElement(suite, "testcase", classname=store, name=entry["name"])
            told = "".join(c if c.isprintable() or c == "\n" else "?" for c in entry["told"])
            if entry in failed:
                failure = ElementTree.SubElement(case, "failure", type=entry["status"])
                failure.text, failure.attrib["message"] = told, told.split("\n")[0]
            elif told and entry["status"] != EXCUSED:
                ElementTree.SubElement(case, "system-out").text = told
    return ElementTree.tostring(top, encoding="utf-8", xml_declaration=True)
