"""One task of an array job: every N-th log of a manifest. With --gather: table and report of all logs.

The task's number, from 0, is AWS_BATCH_JOB_ARRAY_INDEX, JOB_COMPLETION_INDEX (Kubernetes), SLURM_ARRAY_TASK_ID or
--index. Exit codes: 0 every log has a result; 3 so too, but some of the results are failures, which another try
does not mend; 1 a log could not be read or its result not kept: try again; 2 wrong arguments.
"""

import argparse
import os
import sys
from concurrent.futures import ThreadPoolExecutor

from undrift import UndriftError, fleet

NUMBERS = ("AWS_BATCH_JOB_ARRAY_INDEX", "JOB_COMPLETION_INDEX", "SLURM_ARRAY_TASK_ID")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("manifest")
    parser.add_argument("output")
    parser.add_argument("--of", type=int, default=1, help="tasks of the array")
    parser.add_argument("--index", type=int, default=next(filter(None, map(os.getenv, NUMBERS)), 0))
    parser.add_argument("--threads", type=int, default=os.cpu_count(), help="logs at a time")
    parser.add_argument("--gather", action="store_true", help="table and report, when all is done")
    given = parser.parse_args()
    try:
        jobs = fleet.jobs(given.manifest)
        if not given.gather:
            jobs = jobs[given.index :: given.of]
        with ThreadPoolExecutor(given.threads) as pool:
            # What is up to date is only looked at.
            done = list(pool.map(lambda job: fleet.process_to(job, given.output), jobs))
        if given.gather:
            fleet.gather([one.fingerprint for one in done], given.output)
    except (UndriftError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    failed = sum(one.failed for one in done)
    print(f"{len(done)} logs, {sum(one.processed for one in done)} processed, {failed} failed")
    return 3 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
