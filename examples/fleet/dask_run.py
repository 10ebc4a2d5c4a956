"""A fleet on Dask: MANIFEST OUTPUT [SCHEDULER]; without a scheduler on the cores of this machine."""

import sys

from dask.distributed import Client

from undrift import fleet

if __name__ == "__main__":
    manifest, output, *scheduler = sys.argv[1:]
    with Client(*scheduler) as client:
        result = fleet.run(client, manifest, output)
    print(result)
    # 3: some logs failed, and their results say why; 1: some have no result, run again.
    sys.exit(1 if result.lost else 3 if result.failed else 0)
