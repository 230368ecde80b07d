"""Long work as a list of pure tasks, each with a digest, on any ``concurrent.futures.Executor``.

``Task`` describes a computation, ``run`` hands tasks to an executor and stores finished ones in a
``Manifest``, and ``opened`` makes the executor that a command line names.
"""
