"""The Debian package that cpack makes: what it needs, what it holds, and that the command in it runs.

Run as `package_test.py BUILD_FOLDER`.
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1))


def run(*arguments, **keywords):
    return subprocess.run([str(argument) for argument in arguments], capture_output=True, text=True, check=True, **keywords).stdout


class Package(unittest.TestCase):
    def test_holds_a_command_that_runs_with_what_it_says_that_it_needs(self):
        with tempfile.TemporaryDirectory(prefix="raypool-test-") as name:
            folder = pathlib.Path(name)
            run("cpack", "--config", BUILD / "CPackConfig.cmake", "-B", folder)
            package = folder / "raypool.deb"
            needed = run("dpkg-deb", "-f", package, "Depends")
            for library in ("libc6", "libgomp1", "libpng16-16", "libopenexr"):
                self.assertIn(library, needed)
            run("dpkg-deb", "-x", package, folder / "root")
            usr = folder / "root/usr"
            self.assertTrue((usr / "share/man/man1/raypool.1").read_text().startswith(".TH RAYPOOL 1 "))
            self.assertIn("complete -o filenames -F _raypool raypool",
                          (usr / "share/bash-completion/completions/raypool").read_text())
            self.assertIn("hash ", run(usr / "bin/raypool", "render", "one_sphere", "--width", 8, "--spp", 1))


if __name__ == "__main__":
    unittest.main()
