"""The results of finished tasks in a file, by the tasks' digests, so that work goes on where it stopped.

The file is an SQLite database. Committed tasks stay however the process ends, and half-written ones are
rolled back when the file is opened again. Results are committed together, once a second.
"""

import json
import sqlite3
import time
from contextlib import suppress
from pathlib import Path

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks.environment import name_of_worker
from fixedpipe.effects.tasks.task import Outcome

_FORMAT = "fixedpipe tasks, 1"
# Assumed: if a user ends the client with kill -9, the loss of a second's work is acceptable.
_SECONDS_BETWEEN_COMMITS = 1.0
_TABLES = """
CREATE TABLE IF NOT EXISTS about (name TEXT PRIMARY KEY, said TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS done (
    digest TEXT PRIMARY KEY, value TEXT NOT NULL, refused TEXT NOT NULL, seconds REAL NOT NULL,
    worker TEXT NOT NULL, files TEXT NOT NULL
) WITHOUT ROWID;
CREATE TABLE IF NOT EXISTS contents (
    digest TEXT NOT NULL, name TEXT NOT NULL, data BLOB NOT NULL, PRIMARY KEY (digest, name)
);
"""


class Manifest:
    """Finished tasks: their Outcomes by digest.

    path        of the file, which is made if it is missing; None: only in memory
    about       a description of the work; a file with another description is refused
    with_files  whether it also stores the bytes of the tasks' files; otherwise only their names

    One client at a time has the file open. Raises Refusal for a file that another client has open, that
    cannot be read or written, that is damaged or something else, or that is of other work.
    """

    def __init__(self, path, about, *, with_files=False):
        self.path, self._with_files = None if path is None else Path(path), with_files
        try:
            self._file = sqlite3.connect(":memory:" if path is None else path, timeout=0)
            self._file.execute("PRAGMA locking_mode = EXCLUSIVE")
            self._file.execute("BEGIN EXCLUSIVE")  # in this mode the lock stays until the file is closed
            self._begin(about)
        except sqlite3.Error as error:
            raise self._refusal(error) from error
        self._committed = time.monotonic()
        if self.path is not None:
            with suppress(OSError):  # the file is needed only for an error message
                self._client.write_text(name_of_worker())

    @property
    def _client(self):
        """The path of the file that names the client which has the manifest open."""
        return self.path.with_name(f"{self.path.name}.client")

    def _begin(self, about):
        tables = {name for (name,) in self._file.execute("SELECT name FROM sqlite_master")}
        known = dict(self._file.execute("SELECT name, said FROM about")) if "about" in tables else {}
        if tables and known.get("format") != _FORMAT:
            raise Refusal(f"{self.path} is no manifest of tasks; give --manifest another name.")
        if known and known["about"] != about:
            raise Refusal(
                f"{self.path} is the manifest of {known['about']}, and this is {about}; give another "
                "--manifest or --out."
            )
        for statement in _TABLES.split(";"):
            self._file.execute(statement)
        said = (("format", _FORMAT), ("about", about))
        self._file.executemany("INSERT OR IGNORE INTO about VALUES (?, ?)", said)
        self._file.commit()

    def _refusal(self, error):
        said = str(error)
        if "locked" in said:
            client = "another process"
            with suppress(OSError):
                client = f"the process {self._client.read_text()}"
            return Refusal(f"{self.path} is in use by {client}; wait for it, or give another --manifest.")
        if "not a database" in said or "malformed" in said:
            return Refusal(f"{self.path} is no manifest, or is damaged; give --manifest another name.")
        return Refusal(f"{self.path} cannot be written: {said}. What was done before is kept in it.")

    def find(self, digest):
        """The Outcome of a finished task, or None if it is not finished. If the manifest does not store the
        bytes of files, its files have names and no bytes.
        """
        row = self._file.execute(
            "SELECT value, refused, seconds, worker, files FROM done WHERE digest = ?", (digest,)
        ).fetchone()
        if row is None:
            return None
        value, refused, seconds, worker, files = row
        found = dict.fromkeys(json.loads(files), b"")
        if self._with_files:
            found |= dict(self._file.execute("SELECT name, data FROM contents WHERE digest = ?", (digest,)))
        return Outcome(json.loads(value), refused, "", seconds, worker, found)

    def keep(self, digest, outcome):
        """Store an Outcome that did not fail. Raises Refusal if the file cannot be written."""
        row = (
            digest,
            json.dumps(outcome.value, allow_nan=False),  # in the order of its columns
            outcome.refused,
            outcome.seconds,
            outcome.worker,
            json.dumps(sorted(outcome.files)),
        )
        try:
            self._file.execute("INSERT OR REPLACE INTO done VALUES (?, ?, ?, ?, ?, ?)", row)
            if self._with_files:
                contents = [(digest, name, data) for name, data in outcome.files.items()]
                self._file.executemany("INSERT OR REPLACE INTO contents VALUES (?, ?, ?)", contents)
            if time.monotonic() - self._committed >= _SECONDS_BETWEEN_COMMITS:
                self.commit()
        except sqlite3.Error as error:
            raise self._refusal(error) from error

    def forget(self):
        """Remove all stored tasks. Raises Refusal if the file cannot be written."""
        try:
            self._file.execute("DELETE FROM done")
            self._file.execute("DELETE FROM contents")
            self.commit()
        except sqlite3.Error as error:
            raise self._refusal(error) from error

    def commit(self):
        """Write the stored tasks to the disc. Raises Refusal if the file cannot be written."""
        try:
            self._file.commit()
        except sqlite3.Error as error:
            raise self._refusal(error) from error
        self._committed = time.monotonic()

    def __len__(self):
        return self._file.execute("SELECT count(*) FROM done").fetchone()[0]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        """Write the stored tasks if possible, and close the file, so that another client can open it."""
        with suppress(sqlite3.Error):
            self._file.commit()
        self._file.close()
        if self.path is not None:
            self._client.unlink(missing_ok=True)
