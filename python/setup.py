"""Builds the package by the project's own CMake.

    pip install --no-build-isolation --no-index ./python

takes the libraries of the distribution (scripts/setup python) and needs no
network; pip is that of a virtual environment of the distribution's Python. ALIDADE_BUILD=DIR uses a build folder that is there already, such as
build/release configured with -D ALIDADE_BUILD_PYTHON=ON; otherwise the library
is compiled below build/python.
"""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent


def version():
  text = (ROOT / 'CMakeLists.txt').read_text()
  return re.search(r'VERSION ([\d.]+)', text[text.index('project('):])[1]


def fail(message):
  raise SystemExit(f'alidade: {message}')


class CMakeBuild(build_ext):
  """The extension is a target of CMake's."""

  def build_extension(self, ext):
    if importlib.util.find_spec('numpy') is None:
      fail(f'{sys.executable} has no NumPy: make a virtual environment of the '
           "distribution's Python, /usr/bin/python3 -m venv "
           '--system-site-packages my_env, and use its pip')
    build = os.environ.get('ALIDADE_BUILD')
    if not build:
      build = ROOT / 'build' / 'python'
      subprocess.run(
          ['cmake', '-S', ROOT, '-B', build, '-G', 'Ninja',
           '-D', 'CMAKE_BUILD_TYPE=Release', '-D', 'ALIDADE_BUILD_TESTS=OFF',
           '-D', 'ALIDADE_BUILD_PYTHON=ON',
           '-D', f'ALIDADE_PYTHON={sys.executable}'], check=True)
    elif not (pathlib.Path(build) / 'python').is_dir():
      fail(f'ALIDADE_BUILD={build} is no build folder with the package, '
           'expected one that is configured with -D ALIDADE_BUILD_PYTHON=ON')
    subprocess.run(['cmake', '--build', build, '--target', 'alidade_core'],
                   check=True)
    suffix = sysconfig.get_config_var('EXT_SUFFIX')
    built = pathlib.Path(build) / 'python' / 'alidade' / f'_core{suffix}'
    if not built.exists():
      fail(f'{build} is built for another Python than {sys.executable}, '
           'expected -D ALIDADE_PYTHON of the same version')
    target = pathlib.Path(self.get_ext_fullpath(ext.name))
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(built, target)


setup(version=version(),
      ext_modules=[Extension('alidade._core', sources=[])],
      cmdclass={'build_ext': CMakeBuild})
