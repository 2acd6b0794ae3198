"""`pip install .` (docs/python.md): the package in python/raypool/, and within it _core, which CMake builds.

CMAKE_ARGS in the environment is handed on to CMake: CMAKE_ARGS=-DRAYPOOL_ARCH=x86-64-v3 builds for other machines, too.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = Path(__file__).resolve().parent


class CMakeBuild(build_ext):
    """Has CMake build the extension, by the preset `python`."""

    def build_extension(self, extension):
        build = Path(self.build_temp).resolve()
        subprocess.run(["cmake", "--preset", "python", "-B", str(build), f"-DPython_EXECUTABLE={sys.executable}",
                        *shlex.split(os.environ.get("CMAKE_ARGS", ""))], cwd=SOURCE, check=True)
        jobs = ["--parallel", str(self.parallel)] if self.parallel else []
        subprocess.run(["cmake", "--build", str(build), "--target", "raypool_python", *jobs], cwd=SOURCE, check=True)
        target = Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(build / "python" / "raypool" / target.name, target)


version = re.search(r"project\(raypool VERSION ([0-9.]+)", (SOURCE / "CMakeLists.txt").read_text()).group(1)
setup(version=version, ext_modules=[Extension("raypool._core", sources=[])], cmdclass={"build_ext": CMakeBuild})
