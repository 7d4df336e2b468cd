"""All writing of the package: atomic, with locks, and without leftovers.

``system < reading < locks < replacing < sets``, folders, and journals beside them.
"""

from moldloft.storage.folders import make_folders
from moldloft.storage.locks import BusyError, Lock, Owner
from moldloft.storage.reading import (
    LARGEST,
    digest,
    digest_of,
    read_bytes,
    read_text,
    utf8_path,
)
from moldloft.storage.replacing import ChangedError, put
from moldloft.storage.sets import Output, commit, read_set, recover
from moldloft.storage.system import remove
from moldloft.storage.watch import Watch

__all__ = [
    "LARGEST",
    "BusyError",
    "ChangedError",
    "Lock",
    "Output",
    "Owner",
    "Watch",
    "commit",
    "digest",
    "digest_of",
    "make_folders",
    "put",
    "read_bytes",
    "read_set",
    "read_text",
    "recover",
    "remove",
    "utf8_path",
]
