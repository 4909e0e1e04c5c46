"""A Dask cluster on this machine: a scheduler and workers, each a process that can be killed by itself."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType

DASK = Path(sys.executable).parent / "dask"


class Cluster:
    def __init__(self, folder: Path, workers: int = 2) -> None:
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self._folder, self._count = folder, workers
        self._started: list[subprocess.Popen[bytes]] = []

    def __enter__(self) -> Cluster:
        self.start()
        try:
            self._wait_for_scheduler()
        except TimeoutError:
            self.stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def stop(self) -> None:
        for process in self._started:
            process.kill()
        for process in self._started:
            process.wait()

    def start(self) -> None:
        """A scheduler at the address, and workers; those of a scheduler that has gone leave by themselves."""
        port = self.address.rpartition(":")[2]
        self.scheduler = self._dask("scheduler", "--host", "127.0.0.1", "--port", port)
        self.workers = [self.start_worker() for _ in range(self._count)]

    def start_worker(self) -> subprocess.Popen[bytes]:
        return self._dask("worker", self.address, "--nthreads", "1", "--no-nanny", "--death-timeout", "60")

    def _wait_for_scheduler(self) -> None:
        """Waits for the scheduler: on a busy machine Python alone may take longer to start than a client
        waits for an answer."""
        host, _, port = self.address.removeprefix("tcp://").partition(":")
        until_s = time.monotonic() + 120.0
        while time.monotonic() < until_s:
            try:
                socket.create_connection((host, int(port)), timeout=1.0).close()
                return
            except OSError:
                time.sleep(0.1)
        raise TimeoutError((self._folder / "dask.log").read_text())

    def _dask(self, *arguments: str) -> subprocess.Popen[bytes]:
        """One thread is enough, and modules of the tests can be loaded."""
        paths = os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
        with (self._folder / "dask.log").open("a") as log:
            process = subprocess.Popen(
                [DASK, *arguments, "--no-dashboard"],
                cwd=self._folder, env=os.environ | {"PYTHONPATH": paths}, stdout=log, stderr=log,
            )  # fmt: skip
        self._started.append(process)
        return process
