"""Studies on a Dask cluster: each worker is sent the model's files once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from moldloft.study.workers import evaluate_apart, install

__all__ = ["ClusterExecutor", "executor_of"]


class ClusterExecutor(Executor):
    """An executor of a Dask client.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    """

    def __init__(self, client: Any) -> None:
        self.client = client
        self._of = client.get_executor(pure=False)
        self._sent: set[str] = set()
        self._max_workers = max(sum(client.nthreads().values()), 1)

    def submit(  # type: ignore[override]
        self, function: Callable[..., Any], request: Mapping[str, Any]
    ) -> Future[Any]:
        """Submit one case; the model's files are sent before the first one."""
        digest = request["digest"]
        if digest not in self._sent:
            self._send(digest, request["model"], request["root"])
            self._sent.add(digest)
        found: Future[Any] = self._of.submit(evaluate_apart, dict(request))
        return found

    def _send(self, digest: str, model: str, root: str) -> None:
        from distributed import WorkerPlugin

        files = {
            str(path.relative_to(root)): path.read_bytes()
            for path in sorted(Path(root).rglob("*"))
            if path.is_file()
        }
        main = str(Path(model).relative_to(root))

        def setup(plugin: Any, worker: Any) -> None:
            """Writes the files on each worker, including those that join later."""
            install(digest, files, main)

        members = {"name": f"moldloft-{digest[:16]}", "setup": setup}
        self.client.register_plugin(type("ModelFiles", (WorkerPlugin,), members)())


def executor_of(client: Any) -> ClusterExecutor:
    """The executor of a Dask client, for :func:`moldloft.study.sweep`.

    Parameters
    ----------
    client
        A ``distributed.Client``.
    """
    return ClusterExecutor(client)
