"""The files of drawn figures in a folder: records, pictures, the page. Files that no record names are
removed.

index.html              the gallery
plain.html              the same as one page without script
catalogue/NUMBER.html   the meaning of the ids of techniques and figures
ID.json                 a figure's record
records/ID.js           the same as a script
pictures/DIGEST.js      a picture without loss, as a script (fixedpipe.effects.reports.pictures)
pictures/DIGEST.webp    reduced, for the page without script and for passes; DIGEST-480.webp for the grid
"""

import itertools
import json
import os
import re
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

from fixedpipe.effects.reports.files import writable_folder, write_whole
from fixedpipe.effects.reports.gallery import CATALOGUE, INDEX, PLAIN, pages

RECORDS, PICTURES = "records", "pictures"
_PICTURE = re.compile(r"([0-9a-f]{16})(?:\.js|\.webp|-480\.webp)")
# What records of the former layout say, and no others.
_FORMER = b'"difference_gain": '
# The end of a picture's script that is told from another (fixedpipe.effects.reports.pictures.script).
_BASE = re.compile(rb'","([0-9a-f]{16})"\)\n$')
_NAMES = ("digest", "finer", "delta", "preview")


def write_figure(folder, rendered, inputs=None, named=None, threads=None):
    """Write a Rendered figure's pictures and record; returns the record.

    folder   a Path of a folder that is there
    inputs   the digest of its inputs (``figure_inputs``), which the record stores
    named    Plates, which take every picture as a PNG file under its readable name; None: none
    threads  that code pictures; None: one per processor

    A picture that is there already is not written again. Raises Refusal when something cannot be written.
    """
    made_from = {"inputs": inputs, "files": sorted(name for name, _ in rendered.pictures.files())}
    record = {**rendered.record, **made_from}
    pictures = writable_folder(folder / PICTURES)
    new = [(name, data) for name, data in rendered.pictures.files() if not _is_whole(pictures / name)]
    with ThreadPoolExecutor(threads or os.cpu_count()) as pool:  # Python waits while WebP is coded
        for (name, _), data in zip(new, pool.map(lambda file: file[1](), new), strict=True):
            write_whole(pictures / name, data)
    if named is not None:
        for name, image in rendered.named.items():
            named.write(name, image, max(1, len(record["panels"])))
    write_record(folder, record)  # after what it names
    return record


def write_record(folder, record):
    """Write a figure's record in both forms; ``folder``: a Path. Raises Refusal when it cannot be written."""
    records = writable_folder(folder / RECORDS)
    write_whole(records / f"{record['id']}.js", f"record({json.dumps(record)})\n".encode())
    write_whole(folder / f"{record['id']}.json", (json.dumps(record, indent=1) + "\n").encode())


def write_page(folder, figures):
    """Write the pages of all that a folder, a Path, has of ``figures``, ids in the page's order."""
    for name, text in pages(folder, figures).items():
        path = folder / name
        writable_folder(path.parent)
        write_whole(path, text.encode())


def unchanged(folder, identifier, inputs):
    """The record of a figure in a folder, a Path, if it was made from ``inputs``, nothing failed and no file
    is missing; otherwise None.
    """
    try:
        record = json.loads((folder / f"{identifier}.json").read_bytes())
        whole = record["inputs"] == inputs and not record["failures"]
        whole = whole and (folder / RECORDS / f"{identifier}.js").is_file()
        if whole and all(_is_whole(folder / PICTURES / name) for name in record["files"]):
            return record
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        pass  # what cannot be read is drawn again
    return None


def set_aside(folder, figures):
    """Rename the records of a gallery's former layout, which this one cannot show, K12.json to
    K12.json.former; returns how many.
    """
    number = 0
    for path in _records(folder):
        if path.stem.partition("+")[0] in figures and _FORMER in path.read_bytes():
            path.rename(_free(path.with_name(f"{path.name}.former")))
            number += 1
    return number


def _free(path):
    """The path, or with a number behind it the first that is not there."""
    numbered = (path.with_name(f"{path.name}.{number}") for number in itertools.count(2))
    return next(p for p in itertools.chain((path,), numbered) if not p.exists())


def _is_whole(path):
    """Whether a picture's file is there and as long as it says, or ends as a script does."""
    try:
        data = path.read_bytes()
    except OSError:
        return False
    if path.suffix == ".js":
        return data.endswith(b")\n")
    return data[:4] == b"RIFF" and int.from_bytes(data[4:8], "little") + 8 == len(data)


def own_ids(folder):
    """The ids of those figures in a folder, a Path, that files of users hold, in the order of their names."""
    found = {}
    for path in _records(folder):
        with suppress(OSError, ValueError, RecursionError):
            if isinstance(record := json.loads(path.read_bytes()), dict) and "file" in record:
                found[path.stem.partition("+")[0]] = None
    return list(found)


def digests_in(text):
    """Every digest that a record names, from its JSON file's text: a set. ValueError for another."""
    found = set()

    def look(named):
        found.update(digest for name in _NAMES if isinstance(digest := named.get(name), str))
        return named

    json.loads(text, object_hook=look)
    return found


def _bases(folder, named):
    """The digests of the pictures on which named pictures are based, directly or in steps: a set."""
    found, asked = set(), set(named)
    while asked:
        scripts = (folder / PICTURES / f"{digest}.js" for digest in asked)
        ends = (_BASE.search(path.read_bytes()[-30:]) for path in scripts if path.is_file())
        asked = {end[1].decode() for end in ends if end} - found
        found |= asked
    return found


def files_of(folder, figures):
    """The files of the gallery in ``folder``, and its files that no record names.

    The first are its pages, the records of ``figures`` and of their variants, and the files in its two
    folders whose names have the form above and that a record names. The second have names of that form
    too. They include no picture if some record cannot be read, because that record may name it.
    """
    records = [path for path in _records(folder) if path.stem.partition("+")[0] in figures]
    pages_of = [folder / INDEX, folder / PLAIN, *sorted((folder / CATALOGUE).glob("*.html"))]
    named, ours, stale, readable = set(), [*pages_of, *records], [], True
    for path in _records(folder):
        try:
            named |= digests_in(path.read_bytes())
        except (ValueError, OSError, RecursionError):
            readable = False
    named |= _bases(folder, named)
    stems = {path.stem for path in records}
    for path in sorted((folder / RECORDS).glob("*.js")):
        if path.stem.partition("+")[0] in figures:
            (ours if path.stem in stems else stale).append(path)
    for path in sorted((folder / PICTURES).glob("*")):
        if form := _PICTURE.fullmatch(path.name):
            if form[1] in named:
                ours.append(path)
            elif readable:
                stale.append(path)
    return [path for path in ours if path.is_file()], [path for path in stale if path.is_file()]


def tidy(folder, figures, before):
    """Remove the pictures and records of the gallery that no record names any more, among the files
    ``before``, those that existed when the run began (``files_of``). Another run may be writing pictures
    whose record does not exist yet. Returns how many figures and variants there are, and how many bytes their
    files are.
    """
    ours, stale = files_of(Path(folder), figures)
    for path in set(stale) & set(before):
        with suppress(OSError):
            path.unlink()
    number = sum(path.suffix == ".json" for path in ours)
    return number, sum(path.stat().st_size for path in ours)


def _records(folder):
    return sorted(path for path in folder.glob("*.json") if path.is_file())
