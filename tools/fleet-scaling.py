"""A fleet on worker processes of Dask, one thread each: MANIFEST OUTPUT WORKERS."""

import sys

from distributed import Client, LocalCluster

from undrift import fleet

if __name__ == "__main__":
    manifest, output, workers = sys.argv[1:]
    with (
        LocalCluster(
            n_workers=int(workers),
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address=None,
        ) as cluster,
        Client(cluster) as client,
    ):
        print(fleet.run(client, manifest, output, progress=False))
