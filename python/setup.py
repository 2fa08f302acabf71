"""Builds the package by the project's own CMake.

    pip install --no-build-isolation --no-index ./python

takes the libraries of the distribution (scripts/setup python) and needs no
network; pip is that of a virtual environment of the distribution's Python. ALIDADE_BUILD=DIR uses a build folder that is there already, such as
build/release configured with -D ALIDADE_BUILD_PYTHON=ON; otherwise the library
is compiled below build/python.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent


def version():
  text = (ROOT / 'CMakeLists.txt').read_text()
  return re.search(r'VERSION ([\d.]+)', text[text.index('project('):])[1]


class CMakeBuild(build_ext):
  """The extension is a target of CMake's."""

  def build_extension(self, ext):
    build = os.environ.get('ALIDADE_BUILD')
    if not build:
      build = ROOT / 'build' / 'python'
      subprocess.run(
          ['cmake', '-S', ROOT, '-B', build, '-G', 'Ninja',
           '-D', 'CMAKE_BUILD_TYPE=Release', '-D', 'ALIDADE_BUILD_TESTS=OFF',
           '-D', 'ALIDADE_BUILD_PYTHON=ON',
           '-D', f'ALIDADE_PYTHON={sys.executable}'], check=True)
    subprocess.run(['cmake', '--build', build, '--target', 'alidade_core'],
                   check=True)
    built = list((pathlib.Path(build) / 'python' / 'alidade').glob('_core*.so'))
    target = pathlib.Path(self.get_ext_fullpath(ext.name))
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(built[0], target)


setup(version=version(),
      ext_modules=[Extension('alidade._core', sources=[])],
      cmdclass={'build_ext': CMakeBuild})
