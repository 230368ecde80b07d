"""Figures as tasks of any executor: a worker draws one, and the client writes the files' bytes that come.

So a worker needs no folder in common with the client. The files are those that one process alone would write.
"""

import tempfile
import time
from dataclasses import astuple
from pathlib import Path

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.reports.figure_failures import failures_of
from fixedpipe.effects.reports.figure_files import write_record
from fixedpipe.effects.reports.figure_pool import Order
from fixedpipe.effects.reports.files import writable_folder, write_whole
from fixedpipe.effects.reports.plates import Inset, Plates
from fixedpipe.effects.tasks.executors import Workers
from fixedpipe.effects.tasks.run import run
from fixedpipe.effects.tasks.task import Task

_NAMED = "named"  # the folder of readable pictures, among the files


def drawn_files(id, machines, size, with_checks, inputs, file, plates):
    """In a worker: a figure's record and seconds of a processor, and its files. Arguments as of an Order;
    ``plates`` has the Plates' numbers, None without them.
    """
    with tempfile.TemporaryDirectory(prefix="fixedpipe-") as name:
        folder = Path(name)
        named = None
        if plates is not None:
            supersample, gutter, inset = plates
            named = Plates(writable_folder(folder / _NAMED), supersample, gutter, inset and Inset(*inset))
        how = id, tuple(machines), size, None, with_checks, folder, named, inputs, file
        begun = time.process_time()
        record = Order(*how).draw(lambda text: None)
        seconds = time.process_time() - begun
        paths = sorted(path for path in folder.rglob("*") if path.is_file())
        # Records are written last, by the client.
        files = {
            path.relative_to(folder).as_posix(): path.read_bytes()
            for path in paths
            if path.parent != folder and path.parent.name != "records"
        }
        return {"record": record, "seconds": seconds}, files


def draw_by(workers: Workers, orders, step):
    """Draw Orders by an executor: yields (Order, its record, the seconds of a processor that it took) as each
    is done. ``step``: called with a line of text as each is done.

    Each figure has one Order. Raises Refusal as ``tasks.run.run``. What goes wrong with a figure is in its
    record.
    """
    by_digest = {}
    for order in orders:
        parameters = {
            "id": order.id,
            "machines": list(order.machines),
            "size": order.size,
            "with_checks": order.with_checks,
            "inputs": order.inputs,
            "file": order.file,
            "plates": order.named and [order.named.supersample, order.named.gutter, _numbers(order.named)],
        }
        task = Task(drawn_files, parameters, f"{order.id} on {', '.join(order.machines)}", order.inputs or "")
        by_digest[task.digest] = task, order
    tasks = [task for task, _ in by_digest.values()]
    for task, outcome in run(tasks, workers, workers=workers.workers):
        _, order = by_digest[task.digest]
        step(task.said)
        if outcome.failed or outcome.refused:
            yield order, order.failed(Refusal(outcome.failed or outcome.refused)), outcome.seconds
            continue
        record = _written(order, outcome)
        yield order, record, outcome.value["seconds"]
        if any(one["full_disc"] for one in failures_of(record)):
            return


def _numbers(plates):
    """The Inset's fields, None without one."""
    return list(astuple(plates.inset)) if plates.inset else None


def _written(order, outcome):
    """The record of a figure whose files are written now."""
    record = outcome.value["record"]
    try:
        for name, data in outcome.files.items():
            folder, _, rest = name.partition("/")
            place = order.named.folder if folder == _NAMED else writable_folder(order.folder / folder)
            write_whole(place / rest, data)
        write_record(order.folder, record)
    except Refusal as error:
        return order.failed(error)
    return record
