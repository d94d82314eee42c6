"""brushsvg setup inkscape: install the extension where Inkscape looks for it."""

from __future__ import annotations

from ...console import print_text, refuse_errors


def install_plugin(args) -> None:
    from ...install_plugin import install_inkscape, remove_inkscape

    if args.remove:
        with refuse_errors("inkscape"):
            folder = remove_inkscape()
        print_text(f"{folder}: removed; start Inkscape again\n")
        return
    with refuse_errors("inkscape"):
        folder = install_inkscape(args.zip)
    print_text(f"{folder}: installed; start Inkscape again, and look under Extensions > Brush\n")
