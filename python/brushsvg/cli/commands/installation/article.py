"""brushsvg article: the article's figures and tables, computed anew, as a page."""

from __future__ import annotations

import os

from ....errors import Notice
from ...console import RefusedError, about, stage
from ...steps.output_places import check_places, write


def article_files(args) -> None:
    from ....article import article_page

    folder = args.output
    with about(folder):
        made = article_page(stage)
    try:
        os.makedirs(os.path.join(folder, "article"), exist_ok=True)
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        why = Notice("", f"the folder cannot be made: {reason.lower()}", code="file-unwritable")
        raise RefusedError(folder, [why]) from None
    files = {os.path.join(folder, name): data for name, data in made.items()}
    check_places(args, *files)
    write(args, files)
