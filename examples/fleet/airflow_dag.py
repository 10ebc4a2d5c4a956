"""A fleet on Airflow: a mapped task for each shard of the logs, then table and report."""

import os

from airflow.sdk import dag, task

MANIFEST = os.environ.get("FLEET_MANIFEST", "s3://bucket/fleet.toml")
OUTPUT = os.environ.get("FLEET_OUTPUT", "s3://bucket/out")
SHARDS = int(os.environ.get("FLEET_SHARDS", "64"))


@dag(schedule=None, catchup=False)
def fleet_of_logs() -> None:
    @task(retries=3)
    def shard(which: int) -> list[str]:
        from undrift import fleet

        jobs = fleet.jobs(MANIFEST)[which::SHARDS]
        return [fleet.process_to(job, OUTPUT).fingerprint for job in jobs]

    @task
    def gather(shards: list[list[str]]) -> int:
        from undrift import fleet

        # Back into the manifest's order, in which every SHARDS-th log is of one shard.
        longest = max(map(len, shards))
        keys = [keys[k] for k in range(longest) for keys in shards if k < len(keys)]
        return len(fleet.gather(keys, OUTPUT)["failed"])

    gather(shard.expand(which=list(range(SHARDS))))


made = fleet_of_logs()

if __name__ == "__main__":
    made.test()
