"""Many independent jobs: in this process, in processes of this machine, or on a Dask cluster.

A job is a call that needs nothing of another job. `run` makes all of them and returns their results in the
order of the jobs, whatever ran where and in which order. A job whose digest is given is made once: its result
is kept in a file of that name, and the next run takes it from there.

A worker that dies costs the job that it was at, which is tried again, at most ATTEMPTS times in all. A job
that fails is named in one line on stderr, and the others go on; `run` then raises JobsError.
"""

from vista_eval.jobs.job import ATTEMPTS, Failure, Job, jobs_of
from vista_eval.jobs.place import HERE, Place, add_place, chosen_place
from vista_eval.jobs.run import exit_on_failure, outcomes, run

__all__ = [
    "ATTEMPTS",
    "HERE",
    "Failure",
    "Job",
    "Place",
    "add_place",
    "chosen_place",
    "exit_on_failure",
    "jobs_of",
    "outcomes",
    "run",
]
