"""brushsvg install-plugin: our extension put where a drawing program looks."""

from __future__ import annotations

from ...console import about, tell


def install_plugin(args) -> None:
    from ...install_plugin import install_inkscape, remove_inkscape

    if args.remove:
        with about(args.plugin):
            folder = remove_inkscape()
        tell(f"{folder}: removed; start Inkscape again\n")
        return
    with about(args.plugin):
        folder = install_inkscape(args.zip)
    tell(f"{folder}: installed; start Inkscape again, and look under Extensions > Brush\n")
