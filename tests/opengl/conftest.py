"""The worker runs in a process of its own, where Mesa's variables are set; importing it here would fail."""

collect_ignore = ["worker.py"]
