"""What a client of Dask says where the scheduler or all workers have vanished without a word."""

from concurrent.futures import Executor, Future

import pytest

from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.tasks import cluster, executors, run
from fixedpipe.effects.tasks.cluster import Cluster, closed
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.effects.tasks.run import finished
from tests.effects.tasks import works
from tests.effects.tasks.works import tasks_of

THERE = {"tcp://a:1": {"nthreads": 1}, "tcp://b:1": {"nthreads": 4}}


class Client:
    """A client of Dask whose scheduler answers, one after the other, what it is given; errors are raised."""

    def __init__(self, *answers):
        self.answers = list(answers)

    def sync(self, function, callback_timeout):
        answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
        if isinstance(answer, Exception):
            raise answer
        return answer

    def close(self, timeout):
        raise TimeoutError


@pytest.fixture(autouse=True)
def counts_at_once(monkeypatch):
    monkeypatch.setattr(cluster, "_SECONDS_BETWEEN_COUNTS", 0.0)


def at_once(monkeypatch):
    """Nobody is waited for."""
    monkeypatch.setattr(cluster, "SECONDS_UNTIL_LOST", -1.0)


def test_the_threads_of_the_workers_that_count_are_counted():
    assert Cluster(Client(THERE))() == 5
    assert Cluster(Client(THERE), ["tcp://a:1"])() == 1


def test_a_scheduler_that_does_not_answer_is_lost():
    said = r"The scheduler of dask has not answered for 300 s; .* is kept; give the same command"
    with pytest.raises(Refusal, match=said):
        Cluster(Client(TimeoutError()))()


@pytest.mark.parametrize("error", [ConnectionResetError(), AttributeError("identity")])
def test_a_connection_that_is_lost_may_come_again_for_a_time(monkeypatch, error):
    count = Cluster(Client(THERE, error))
    assert [count(), count()] == [5, 5]
    at_once(monkeypatch)
    with pytest.raises(Refusal, match="has not answered for"):
        count()


def test_a_cluster_that_has_no_worker_for_long_is_lost_but_a_users_own(monkeypatch):
    count = Cluster(Client(THERE, {}, {}, THERE, {}), waits_for_workers=False)
    assert [count() for _ in range(4)] == [5, 0, 0, 5]
    at_once(monkeypatch)
    with pytest.raises(Refusal, match=r"has had no worker for .* s; begin some by dask worker .* is kept"):
        count()
    assert Cluster(Client({}))() == 0


def test_a_client_whose_scheduler_does_not_answer_is_closed_all_the_same():
    closed(Client(None))


def test_who_waits_for_calls_looks_after_the_workers(monkeypatch):
    monkeypatch.setattr(run, "SECONDS_BETWEEN_LOOKS", 0.0)
    call, looks = Future(), []

    def workers():
        looks.append(1)
        if len(looks) == 3:
            call.set_result(None)
        return 1

    assert finished([call], workers) == {call} and len(looks) == 3


@pytest.mark.parametrize("computed", [run.run, in_order])
def test_calls_that_nobody_answers_any_more_end_by_a_sentence(monkeypatch, computed):
    """The scheduler answers when the calls are sent, and then no more."""
    monkeypatch.setattr(run, "SECONDS_BETWEEN_LOOKS", 0.0)

    class Silent(Executor):
        def submit(self, function, /, *arguments):
            client.answers = [TimeoutError()]
            return Future()

    client = Client(THERE)
    workers = executors.Workers(Silent(), Cluster(client))
    more = {"workers": workers.workers} if computed is run.run else {}
    with pytest.raises(Refusal, match="has not answered for"):
        list(computed(tasks_of(works.squared), workers, **more))
