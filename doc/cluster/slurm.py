"""Workers of VISTA as jobs of Slurm: prints the address for `--cluster`, and stays until Ctrl-C.

    pip install dask-jobqueue        # into the environment of VISTA, on a file system that all nodes see
    python slurm.py --workers 200 --account PROJECT
    vista worlds /scratch/worlds --cluster tcp://LOGIN-NODE:8786

A worker has one core and one thread. It leaves before its Slurm job ends, and another job takes its place:
what it was at is made again elsewhere.
"""

from __future__ import annotations

import argparse
import signal

from dask_jobqueue import SLURMCluster

WORKERS_EACH_JOB = 8
PORT = 8786


def make_cluster(account: str, environment: str) -> SLURMCluster:
    return SLURMCluster(
        account=account,
        cores=WORKERS_EACH_JOB,  # one for each worker
        processes=WORKERS_EACH_JOB,
        memory=f"{3 * WORKERS_EACH_JOB}GB",
        walltime="08:00:00",
        job_script_prologue=[f"source {environment}/bin/activate", "export OMP_NUM_THREADS=1"],
        worker_extra_args=["--lifetime", "7h", "--lifetime-stagger", "30m"],
        scheduler_options={"port": PORT},
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--workers", type=int, required=True)
    parser.add_argument("--account", required=True)
    parser.add_argument("--environment", default=".venv", help="folder of the environment of VISTA")
    arguments = parser.parse_args()
    with make_cluster(arguments.account, arguments.environment) as cluster:
        cluster.adapt(minimum=0, maximum=arguments.workers)  # none while there is nothing to do
        print(f"--cluster {cluster.scheduler_address}", flush=True)
        signal.sigwait({signal.SIGINT, signal.SIGTERM})


if __name__ == "__main__":
    main()
