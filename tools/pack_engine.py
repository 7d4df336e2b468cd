"""Packs the engine for pages: `python tools/pack_engine.py moldloft_engine.wasm engine.wasm.xz`.

XZ takes 60 % of what gzip takes. Browsers unpack gzip only by themselves; the worker of the page
has a decoder (xz-decompress, MIT, 20 kB), which knows the check CRC-32.
"""

from __future__ import annotations

import lzma
import sys
from pathlib import Path

#: A window as large as the engine; what follows a byte does not depend on where it stands.
_FILTER = {"id": lzma.FILTER_LZMA2, "preset": 9 | lzma.PRESET_EXTREME, "lc": 4, "lp": 0, "pb": 0}


def packed(engine: bytes) -> bytes:
    """The engine as the page carries it."""
    return lzma.compress(engine, format=lzma.FORMAT_XZ, check=lzma.CHECK_CRC32, filters=[_FILTER])


if __name__ == "__main__":
    source, target = map(Path, sys.argv[1:])
    target.parent.mkdir(parents=True, exist_ok=True)
    draft = target.with_name(f"{target.name}.new")
    draft.write_bytes(packed(source.read_bytes()))
    draft.replace(target)
    print(f"{target.name}: {target.stat().st_size / 1e6:.2f} MB")
