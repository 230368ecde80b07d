"""Test vectors in a folder: JSON files with a case on each line, pixels of frames, an index of digests."""

import hashlib
import json

from fixedpipe.effects.arithmetic.rules import RULES
from fixedpipe.effects.emulators.single_steps import single_step_files
from fixedpipe.effects.reports.files import writable_folder, write_whole
from fixedpipe.pipeline.golden.provenance import package_version, provenance
from fixedpipe.pipeline.golden.vectors import STAGES, frame_case, raw_planes, stage_case
from fixedpipe.pipeline.profiles import NV2A

FORMAT = 1


def write_vectors(folder, profile, cases, frames, seed):
    """Write ``cases`` of each stage that the machine has, and ``frames``, from the seed on; the files' names.

    Raises Refusal for a folder that cannot be written, and ValueError for a machine that draws none.
    """
    files = {}
    for stage in STAGES:
        if stage == "combiners" and not profile.combiners.max_general_combiners:
            continue
        made = (stage_case(stage, profile, seed + k) for k in range(cases))
        files[f"{stage}.json"] = _lines({"stage": stage}, made)
    if frames:
        writable_folder(folder / "frames")
    for k in range(frames):
        case, framebuffer = frame_case(profile, seed + k)
        name = f"frames/{seed + k:06}"
        planes = {f"{name}.{plane}": data for plane, data in raw_planes(framebuffer).items()}
        files |= planes
        case["depth_bits"], case["expected"] = framebuffer.depth_bits, sorted(planes)
        files[f"{name}.json"] = _lines({}, [case])
    return _write(folder, files, profile, seed)


def write_rules(folder, cases, seed):
    """Write a file for each rule of the NV2A's arithmetic, ``cases`` random ones behind its edges; the files'
    names.

    Raises Refusal for a folder that cannot be written.
    """
    writable_folder(folder / "rules")
    files = {f"rules/{rule.id}.json": _lines(rule.head(), rule.cases(cases, seed)) for rule in RULES.values()}
    return _write(folder, files, NV2A, seed)


def write_single_steps(folder, cases, seed):
    """Write the rules' vectors in SingleStepTests' form, ``cases`` random ones behind the edges; the files'
    names.

    Raises Refusal for a folder that cannot be written.
    """
    writable_folder(folder / "v1")
    return _write_each(folder, single_step_files(cases, seed, package_version()))


def write_code(folder, files_of, functions):
    """Write files of code and an index of ``functions``, by rule, with the files' digests; all names.

    ``files_of``: the files' contents by name, of the package's version.
    """
    version = package_version()
    files = files_of(version)
    index = {"format": FORMAT, "fixedpipe": version, "rules": functions, "files": _digests(files)}
    index_data = (json.dumps(index, indent=1) + "\n").encode()
    return _write_each(folder, files | {"index.json": index_data})


def _digests(files):
    return {name: hashlib.sha256(data).hexdigest() for name, data in sorted(files.items())}


def _write_each(folder, files):
    for name, data in files.items():
        write_whole(folder / name, data)
    return [*files]


def _write(folder, files, profile, seed):
    """Write the files, and the index of them; all names."""
    _write_each(folder, files)
    known = provenance(profile)
    index = {
        "format": FORMAT,
        **{name: known[name] for name in ("profile", "fixedpipe", "kernels")},
        "seed": seed,
        "files": _digests(files),
    }
    write_whole(folder / "index.json", (json.dumps(index, indent=1) + "\n").encode())
    return [*files, "index.json"]


def _lines(head, cases):
    """A JSON object with ``format``, ``head`` and ``cases``, with one line for each case."""
    begin = json.dumps({"format": FORMAT, **head})[:-1]
    lines = ",\n".join(json.dumps(case) for case in cases)
    return f'{begin}, "cases": [\n{lines}\n]}}\n'.encode()
