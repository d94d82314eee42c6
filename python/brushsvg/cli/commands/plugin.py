"""brushsvg install-plugin: our extension put where a drawing program looks."""

from __future__ import annotations

from ..console import about, tell


def install_plugin(args) -> None:
    from ..install_plugin import install_inkscape

    with about(args.plugin):
        folder = install_inkscape(args.zip)
    tell(f"{folder}: installed; start Inkscape again, and look under Extensions > Brush\n")
