"""Check usage errors that argparse does not detect.

These are wrong extensions, files that are named twice, and flags that require another flag.
"""

from __future__ import annotations

import os

from ...files import find_file_used_twice
from ...machine.posts import POSTS
from ...read import READERS

DRAWINGS = (*READERS, ".json")
PROGRAMS = tuple(dict.fromkeys(extension for post in POSTS.values() for extension in post.extensions))
PICTURES = (".png", ".svg")


def suffix_of(path: str) -> str:
    return os.path.splitext(path)[1].lower()


def check_drawing(args) -> None:
    """Refuse flags that need a drawing of another kind, or another flag."""
    if args.units and suffix_of(args.input) in (".svg", ".svgz"):
        args.parser.error("--units is for drawings that do not define their unit; an SVG does")
    if args.select and suffix_of(args.input) == ".dxf":
        args.parser.error("--select is for SVG; choose layers of a DXF with --layer")
    check_compensation(args)


def check_compensation(args) -> None:
    """Refuse flags that need another compensation than the typed one.

    Without a typed one, the project file or the drawing may name it.
    """
    if args.lag is not None and args.compensation not in (None, "constant"):
        args.parser.error("--lag needs --compensation constant")
    for flag in ("terminals", "start", "end"):
        if args.compensation in ("none", "constant") and getattr(args, flag) not in (None, "auto"):
            args.parser.error(f"--{flag} needs --compensation closed or refined, not {args.compensation}")


def check_job(args) -> None:
    """Refuse flags that only a program can follow, because a plan would ignore them."""
    for flag, value in (
        ("--from-stroke", getattr(args, "from_stroke", 1) - 1),
        ("--z-offset", args.z_offset),
    ):
        if value and suffix_of(args.output) == ".json":
            args.parser.error(f"{flag} is for programs; a plan (.json) always has the whole job, on the paper")


def check_files(args, read, written) -> None:
    """Refuse files with a wrong extension, and a written file that is named twice.

    read, written: pairs of a path or None, and the extensions that it may have, or None for any extension.
    """
    for path, suffixes in (*read, *written):
        if path is not None and suffixes:
            check_extension(args, path, suffixes)
    if twice := find_file_used_twice([path for path, _ in read], [path for path, _ in written]):
        args.parser.error(f"{twice} is named for two files: name another file for one of them")


def check_extension(args, path: str, suffixes: tuple[str, ...]) -> None:
    if suffix_of(path) not in suffixes:
        problem = "is a folder, and no file that ends in" if os.path.isdir(path) else "does not end in"
        args.parser.error(f"{path} {problem} {' or '.join(suffixes)}")
