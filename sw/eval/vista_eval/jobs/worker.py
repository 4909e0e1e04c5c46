"""What a job may want to know of the process that it runs in."""

from __future__ import annotations

from multiprocessing import parent_process


def is_worker() -> bool:
    """One of several that share a machine, each with one core; not the process that asks."""
    return parent_process() is not None


def keep_to_one_core() -> None:
    """Keeps a worker to one core, for libraries that otherwise start a thread for each core of the
    machine."""
    if is_worker():
        import drjit

        drjit.set_thread_count(1)
