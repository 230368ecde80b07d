"""Long work as a list of pure tasks, each with a digest, on any ``concurrent.futures.Executor``.

``Task`` says what is to be computed, ``run`` hands tasks to an executor and keeps what is done in a
``Manifest``, and ``opened`` makes the executor that a command line names.
"""
