"""Write the article's figures and tables, computed again, as a page: python examples/article FOLDER"""

import sys
from pathlib import Path

from page import article_page


def main(argv: list[str]) -> int:
    if len(argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    folder = Path(argv[1])
    (folder / "article").mkdir(parents=True, exist_ok=True)
    for name, data in article_page(lambda text: print(text, file=sys.stderr)).items():
        (folder / name).write_bytes(data)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
