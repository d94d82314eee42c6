"""List the parts of the safety code; `plant --safety N` plants N faults in each."""

from __future__ import annotations

from pathlib import PurePosixPath

from fault import Fault

PARTS = {
    "move extents": ("machine/limits/move_extents.py", "machine/realised/corner_blending.py"),
    "workspace limits": ("machine/limits/*.py", "machine/realised/tilt.py", "machine/preflight.py"),
    "check": ("verify/*.py", "jobs/checking.py"),
    "posts": ("machine/posts/*.py", "machine/writer.py", "cpp/posts/*.cpp"),
    "readback": ("verify/readback/*.py",),
    "bounds of corrections": (
        "comparison/corrections.py",
        "comparison/next_corrections.py",
        "comparison/attribution/corrected_cell.py",
    ),
    "paint loads": ("machine/paint_reload.py", "machine/dry_brush.py", "cpp/inverse/paint_loads.cpp"),
}


def part_of(fault: Fault) -> str | None:
    """Return the part whose files contain a fault."""
    path = PurePosixPath(fault.file)
    for part, patterns in PARTS.items():
        for pattern in patterns:
            whole = pattern if pattern.startswith("cpp/") else f"python/brushsvg/{pattern}"
            if len(path.parts) == whole.count("/") + 1 and path.match(whole):
                return part
    return None
