"""The real Inkscape with our extension, in a separate profile."""

import os
import shutil
import subprocess
from pathlib import Path

from command import COMMAND

SHIPPED = "/usr/share/inkscape/extensions"  # Inkscape lets scripts import modules from this folder
SOURCE = Path(__file__).parents[2] / "plugins" / "inkscape"


class Plugin:
    """Inkscape with our extension.

    Inkscape runs our scripts with the system's Python, as usual, and finds brushsvg on PATH.
    """

    def __init__(self, folder: Path, command: Path | None = COMMAND):
        self.folder = folder
        self.profile = folder / "profile"
        self.installed = self.profile / "extensions" / "brushsvg"
        shutil.copytree(SOURCE, self.installed)
        self.set()
        programs = folder / "programs"
        programs.mkdir()
        if command is not None:
            (programs / "brushsvg").symlink_to(command)
        self.env = {
            **os.environ,
            "INKSCAPE_PROFILE_DIR": str(self.profile),
            "HOME": str(folder),
            "PATH": f"{programs}:/usr/bin:/bin",
        }
        for name in ("DISPLAY", "VIRTUAL_ENV", "PYTHONPATH"):
            self.env.pop(name, None)

    def set(self, **parameters: str) -> None:
        """Set values that dialogs of extensions remember.

        `preview__brush="rigid"` sets a value of org.brushsvg.preview.
        """
        attributes = " ".join(f'org.brushsvg.{k.replace("__", ".")}="{v}"' for k, v in parameters.items())
        (self.profile / "preferences.xml").write_text(
            '<inkscape xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd" version="1">'
            f'<group id="extensions" python-interpreter="/usr/bin/python3" {attributes}/></inkscape>'
        )

    def save(self, drawing: Path, out: Path, entry: str = "") -> subprocess.CompletedProcess:
        """Save a copy, as a person would.

        entry selects a file type if several have this extension.
        """
        chosen = [f"--export-extension=org.brushsvg.save.{entry}"] if entry else []
        return self._run(["/usr/bin/inkscape", *chosen, f"--export-filename={out}", str(drawing)])

    def effect(self, name: str, drawing: Path, out: Path, select: str = "") -> Path:
        """Run an effect and save the drawing; select holds ids with commas between."""
        chosen = f"select-by-id:{select};" if select else ""
        self.batch(drawing, out, f"{chosen}org.brushsvg.{name}.noprefs")
        assert out.exists()
        return out

    def batch(self, drawing: Path, out: Path, *actions: str) -> subprocess.CompletedProcess:
        """Run Inkscape with a display and without a user."""
        words = f"--actions={';'.join([*actions, f'export-filename:{out}', 'export-do'])}"
        return self._run(["xvfb-run", "-a", "inkscape", "--batch-process", words, str(drawing)])

    def script(self, name: str, drawing: Path, *words: str, before: tuple = ()) -> subprocess.CompletedProcess:
        """Run the script as Inkscape does, to read the text of its dialog.

        before holds words that start the script.
        """
        script = str(self.installed / f"brushsvg_{name}.py")
        start = [*before, "/usr/bin/env", f"PYTHONPATH={SHIPPED}", "/usr/bin/python3"]
        return self._run([*start, script, *words, str(drawing)])

    def _run(self, words) -> subprocess.CompletedProcess:
        return subprocess.run(words, env=self.env, cwd=self.folder, capture_output=True, timeout=40, check=False)


def sentence(done: subprocess.CompletedProcess) -> str:
    reported = done.stderr.decode()
    assert done.returncode == 1 and done.stdout == b"" and reported and "Traceback" not in reported
    return reported
