#!/usr/bin/python3
"""The Python package as users get it: by `cmake --install`, and by pip into a
virtual environment. Either is imported and calibrates, from a folder where
nothing else could be imported by mistake.

Usage: install_test.py SOURCE BUILD WORK CMAKE [LIBRARY:LIBRARY...]
  LIBRARY   loaded before the interpreter, which knows nothing of sanitizers
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

SOURCE, BUILD, WORK = map(pathlib.Path, sys.argv[1:4])
CMAKE = sys.argv[4]
PRELOADED = sys.argv[5] if len(sys.argv) > 5 else ''

CALIBRATION = """
import importlib.metadata, pathlib, sys
import numpy as np
import alidade

assert pathlib.Path(alidade.__file__).is_relative_to(sys.argv[1]), (
    alidade.__file__)
assert alidade.__version__ == sys.argv[2], alidade.__version__
assert importlib.metadata.version('alidade') == sys.argv[2]
package = pathlib.Path(alidade.__file__).parent
assert (package / 'py.typed').exists() and (package / '_core.pyi').exists()
arm = alidade.Arm.from_dh(convention='craig', alpha=[0, -np.pi / 2, 0],
                          a=[0, 0, 0.25], d=[0.3, 0, 0],
                          limits=[[-2, 2]] * 3)
real = arm.with_deviations({'d3': 1e-3, 'theta2': 2e-3})
data = alidade.simulate(real, count=40, sigma=2e-5)
result = alidade.calibrate(arm, data, errors='none')
assert abs(result['d3'].value - 0.251) < 5 * result['d3'].std, result['d3']
"""


def run(*command, **variables):
  environment = {key: value for key, value in os.environ.items()
                 if not key.startswith(('PYTHON', 'LD_PRELOAD', 'VIRTUAL_ENV'))}
  environment.update(variables)
  subprocess.run([str(part) for part in command], check=True, cwd=WORK,
                 env=environment)


def calibrate(interpreter, installed, version, **variables):
  if PRELOADED:
    variables['LD_PRELOAD'] = PRELOADED
    variables['ASAN_OPTIONS'] = 'detect_leaks=0'
  run(interpreter, '-c', CALIBRATION, installed, version, **variables)


def test_install(interpreter, version):
  prefix = WORK / 'prefix'
  run(CMAKE, '--install', BUILD, '--prefix', prefix, '--component', 'python')
  package = next(prefix.glob('lib/python3*/*-packages'))
  # Nothing but the package.
  assert {path.name for path in package.iterdir()} == {
      'alidade', f'alidade-{version}.dist-info'}
  assert {path.name for path in prefix.iterdir()} == {'lib'}
  calibrate(interpreter, prefix, version, PYTHONPATH=str(package))


def test_pip(interpreter, version):
  """As docs/python.md has it, with a build folder that is there."""
  environment = WORK / 'venv'
  run(interpreter, '-m', 'venv', '--system-site-packages', environment)
  # pip builds where the sources are.
  shutil.copy(SOURCE / 'CMakeLists.txt', WORK)
  shutil.copytree(SOURCE / 'python', WORK / 'python',
                  ignore=shutil.ignore_patterns('build', '*.egg-info'))
  run(environment / 'bin/pip', 'install', '--quiet', '--no-build-isolation',
      '--no-index', '--disable-pip-version-check', './python',
      ALIDADE_BUILD=str(BUILD))
  calibrate(environment / 'bin/python', environment, version)


def main():
  shutil.rmtree(WORK, ignore_errors=True)
  WORK.mkdir(parents=True)
  text = (SOURCE / 'CMakeLists.txt').read_text()
  version = re.search(r'VERSION (\d+\.\d+\.\d+)\n', text)[1]
  test_install(sys.executable, version)
  test_pip(sys.executable, version)


main()
