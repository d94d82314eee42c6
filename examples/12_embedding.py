"""Call brushsvg from your own application: input in memory, progress, cancel, and errors as sentences.

Run: python examples/12_embedding.py. It writes no file: your application gets texts.
"""

import threading
from concurrent.futures import CancelledError, ThreadPoolExecutor
from xml.etree import ElementTree

import brushsvg

PAGE = '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="50mm" viewBox="0 0 100 50">{}</svg>'
WAVE = '<path id="wave" fill="none" stroke="black" stroke-width="{}" d="M 20 25 C 40 0 60 50 80 25"/>'


def paint(svg: str, stop: threading.Event) -> str:
    """Return a program, or a sentence that says why there is none. This runs in a thread of your application."""
    try:
        done = brushsvg.convert(
            ElementTree.fromstring(svg),
            formats=[".ngc"],
            wide="refuse",
            progress=lambda text: print("  progress:", text),
            cancel=stop,
        )
    except CancelledError:
        return "cancelled"
    except brushsvg.Error as refused:  # refused.code stays the same when the words change
        return f"refused ({refused.code}): {refused.where}: {refused}"
    return f"a program of {len(done.texts['.ngc'])} characters, {done.time_s:.0f} s"


stop = threading.Event()  # set by a button
with ThreadPoolExecutor(1) as pool:
    print("line:", pool.submit(paint, PAGE.format(WAVE.format(4)), stop).result())
    print("wide line:", pool.submit(paint, PAGE.format(WAVE.format(40)), stop).result())
    stop.set()
    print("stopped:", pool.submit(paint, PAGE.format(WAVE.format(4)), stop).result())
