"""A fleet on Ray: MANIFEST OUTPUT. Address and resources are those of `ray.init`."""

import sys

import ray

from undrift import fleet

#: Tasks that Ray has at a time: a few for each core.
WINDOW = 64


@ray.remote(max_retries=3, retry_exceptions=True)
def one(job: str, output: str) -> fleet.Done:
    return fleet.process_to(job, output)


def main(manifest: str, output: str) -> None:
    ray.init()
    jobs = fleet.jobs(manifest)
    keys = [""] * len(jobs)
    waiting: dict[ray.ObjectRef, int] = {}

    def take() -> None:
        [ready], _ = ray.wait(list(waiting))
        keys[waiting.pop(ready)] = ray.get(ready).fingerprint

    for place, job in enumerate(jobs):
        if len(waiting) == WINDOW:
            take()
        waiting[one.remote(job, output)] = place
    while waiting:
        take()
    summary = fleet.gather(keys, output)
    print(f"{len(jobs)} logs, {len(summary['failed'])} failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
