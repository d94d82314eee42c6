"""Zip the Inkscape extension for the extension manager.

    zip_plugin.py FOLDER OUT

Equal files give equal bytes.
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path


def main(folder: str, out: str) -> None:
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as file:
        for path in sorted(Path(folder).iterdir()):
            if path.suffix in (".py", ".inx") or path.name == "LICENSE":
                entry = zipfile.ZipInfo(f"brushsvg/{path.name}", date_time=(1980, 1, 1, 0, 0, 0))
                entry.compress_type, entry.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
                file.writestr(entry, path.read_bytes())
    print(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
