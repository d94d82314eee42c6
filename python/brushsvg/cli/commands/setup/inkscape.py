"""brushsvg setup inkscape: install the extension where Inkscape looks for it."""

from __future__ import annotations

from ...console import about, print_text


def install_plugin(args) -> None:
    from ...install_plugin import install_inkscape, remove_inkscape

    if args.remove:
        with about("inkscape"):
            folder = remove_inkscape()
        print_text(f"{folder}: removed; start Inkscape again\n")
        return
    with about("inkscape"):
        folder = install_inkscape(args.zip)
    print_text(f"{folder}: installed; start Inkscape again, and look under Extensions > Brush\n")
