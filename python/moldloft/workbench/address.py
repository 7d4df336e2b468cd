"""The address of a model's page, kept across servers.

It is in ``$XDG_STATE_HOME/moldloft/addresses.json``.

With the port of the last server, the browser finds the settings that it keeps by address. Open
pages connect again when they prove that they have the secret of the last server. It is never sent
to an unknown server: another program may listen at the port meanwhile.
"""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import json
import secrets
from dataclasses import asdict, dataclass
from pathlib import Path

from moldloft.errors import Error, FileError
from moldloft.storage import make_folders, put, read_bytes
from moldloft.storage.journal import state_folder

__all__ = ["Address", "keep_address", "kept_address", "proof"]

#: Models whose addresses are kept.
_MOST = 50


@dataclass(frozen=True)
class Address:
    """Port and secrets of a server."""

    port: int
    """0 for any free port."""
    secret: str
    """The secret shared by the pages of this server only."""


def _file() -> Path:
    return state_folder().parent / "addresses.json"


def _all() -> dict[str, Address]:
    with contextlib.suppress(ValueError, TypeError, FileError, OSError):
        found = json.loads(read_bytes(_file()))
        return {
            path: Address(int(row["port"]), row["secret"])
            for path, row in found.items()
            if isinstance(row, dict)
            and isinstance(row.get("port"), int)
            and 0 <= row["port"] < 65536
            and isinstance(row.get("secret"), str)
            and len(row["secret"]) >= 32
        }
    return {}


def kept_address(model: Path) -> Address:
    """The address of the model's previous server, or a new one at any port."""
    return _all().get(str(model.resolve())) or Address(0, secrets.token_urlsafe(32))


def proof(secret: str, port: int, challenge: str) -> str:
    """A page's answer to the challenge of a server at a port, given its secret.

    >>> len(proof("secret", 8000, "challenge"))
    64
    """
    return hmac.new(secret.encode(), f"{port} {challenge}".encode(), hashlib.sha256).hexdigest()


def keep_address(model: Path, address: Address) -> None:
    """Keep the address for the next server of a model.

    Parameters
    ----------
    model
        The model's file. Where nothing can be kept, nothing is.
    address
        Its address.
    """
    path = str(model.resolve())
    rest = [item for item in _all().items() if item[0] != path]
    kept = {name: asdict(one) for name, one in [*rest, (path, address)][-_MOST:]}
    with contextlib.suppress(OSError, Error, UnicodeError):
        make_folders(_file().parent)
        put(_file(), json.dumps(kept, indent=1).encode(), private=True)
