"""An S3 server on loopback that counts what it is asked."""

from __future__ import annotations

import logging
import threading
import urllib.request
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest


@contextmanager
def served(monkeypatch: pytest.MonkeyPatch) -> Iterator[Counter[tuple[str, str]]]:
    """A server for as long as it lasts, found by the environment, also of child processes; the numbers of requests by
    method and path."""
    pytest.importorskip("s3fs")
    server_of = pytest.importorskip("moto.server")
    serving = pytest.importorskip("werkzeug.serving")
    counts: Counter[tuple[str, str]] = Counter()
    lock = threading.Lock()
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    application = server_of.DomainDispatcherApplication(server_of.create_backend_app)

    def counting(environ: dict[str, Any], start: Any) -> Any:
        listing = "list-type" in environ.get("QUERY_STRING", "")
        method = "LIST" if listing else environ["REQUEST_METHOD"]
        with lock:
            counts[method, environ["PATH_INFO"]] += 1
        return application(environ, start)

    server = serving.make_server("127.0.0.1", 0, counting, threaded=True)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    address = f"http://127.0.0.1:{server.server_port}"
    # The buckets are the process's, not the server's.
    urllib.request.urlopen(f"{address}/moto-api/reset", data=b"").close()
    for name, value in {
        "AWS_ENDPOINT_URL": address,
        "AWS_ACCESS_KEY_ID": "testing",
        "AWS_SECRET_ACCESS_KEY": "testing",
        "AWS_DEFAULT_REGION": "us-east-1",
    }.items():
        monkeypatch.setenv(name, value)
    try:
        yield counts
    finally:
        server.shutdown()
        thread.join()


def read(counts: Counter[tuple[str, str]], below: str) -> dict[str, int]:
    """How often each object below a path was read."""
    return {
        path: number
        for (method, path), number in counts.items()
        if method == "GET" and path.startswith(below)
    }
