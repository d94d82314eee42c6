"""The article figure by figure: scripts that anyone can copy, run one by one, and the page that shows them.

A script of figures/ uses public names only, in 40 lines at most. It leaves `figure`, a matplotlib Figure, and `rows`:
(what, the printed number or None, ours). Its docstring is the title and what there is to say, in particular why a print
cannot be reproduced.
"""

from .page import article_page

__all__ = ["article_page"]
