#!/usr/bin/env python3
"""Plants violations of the fences in a small tree, one at a time, and expects
check_fences.py to find each, and to find nothing in the clean tree."""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).parent / 'check_fences.py'
CLEAN = {
    'include/alidade/arm.h':
        '#include "alidade/units.h"\nnamespace alidade {\nstruct Arm {};\n}\n',
    'include/alidade/units.h': 'namespace alidade {\nclass Unit {};\n}\n',
    'src/model/arm.cc':
        '#include "alidade/arm.h"\n#include "src/model/chain.h"\n'
        'namespace alidade {\nvoid F() {}\n}\n',
    'src/model/chain.h':
        '#include "alidade/units.h"\nnamespace alidade::internal {\n'
        'struct Chain { int a = 0; };\n}\n',
    'src/model/chain-inl.h': '#include "src/model/chain.h"\n',
    'src/model/chain.cc': '#include "src/model/chain-inl.h"\n',
    'src/kernel/cost.h':
        '#include <ceres/jet.h>\nnamespace ceres {\nclass Problem;\n}\n',
    'src/dataio/reader.h': '#include "yaml-cpp/yaml.h"\n',
    'src/cli/mpi_communicator.cc': '#include <mpi.h>\nnamespace alidade::internal {\n'
        'namespace {\nclass Chain {};\n}\nvoid G() { MPI_Finalize(); }\n}\n',
    'src/cli/main.cc': '#include <gflags/gflags.h>\n#include <glog/logging.h>\n'
        'DEFINE_bool(x, false, "");\nint main() { return 0; }\n',
    'tests/model/arm_test.cc': 'namespace alidade::internal {\n'
        'class Fixture {};\n}\n',
    'tests/solve/arm_test.cc': 'namespace alidade::internal {\n'
        'class Fixture {};\n}\n',
    'bench/study.cc': '// line\n' * 500,
}


class FencesTest(unittest.TestCase):

  def setUp(self):
    self.tree = pathlib.Path(tempfile.mkdtemp())
    self.addCleanup(shutil.rmtree, self.tree)
    for path, text in CLEAN.items():
      self.plant(path, text)

  def plant(self, path, text):
    (self.tree / path).parent.mkdir(parents=True, exist_ok=True)
    (self.tree / path).write_text(text)

  def check(self, *libraries):
    run = subprocess.run([sys.executable, CHECK, self.tree, *libraries],
                         stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True, check=False)
    self.assertEqual(run.returncode != 0, run.stdout != '', run.stderr)
    return run.stdout

  def expect(self, path, text, line, message):
    """One violation alone, there, once the file is planted."""
    self.plant(path, text)
    found = self.check()
    self.assertIn(f'{path}:{line}: {message}', found)
    self.assertEqual(found.count('\n'), 1, found)

  def test_clean_tree(self):
    self.assertEqual(self.check(), '')

  def test_arrows(self):
    self.expect('src/model/joint.h', '#include <array>\n'
                '#  include "src/dataio/reader.h"\n', 2,
                'model must not include src/dataio/reader.h of dataio')
    (self.tree / 'src/model/joint.h').unlink()
    # What others may include on the way counts, what others include does not.
    self.plant('src/planning/plan.h', '#include "src/kernel/cost.h"\n')
    self.expect('src/report/page.h', '#include "src/dataio/reader.h"\n', 1,
                'report must not include')

  def test_public_headers_are_of_their_sources_module(self):
    self.plant('include/alidade/summary.h', '')
    self.plant('src/solve/summary.cc', '#include "alidade/summary.h"\n')
    self.plant('src/solve/use.h', '#include "alidade/summary.h"\n')
    self.expect('src/kernel/use.h', '#include "alidade/summary.h"\n', 1,
                'kernel must not include alidade/summary.h of solve')

  def test_public_headers_include_public_ones(self):
    self.expect('include/alidade/arm.h', '#include "src/model/joint.h"\n', 1,
                'a public header includes src/model/joint.h')

  def test_modules_are_known(self):
    self.expect('src/extra/new.cc', '', 1, 'is in no module')
    (self.tree / 'src/extra/new.cc').unlink()
    self.expect('include/alidade/new.h', '', 1, 'no src/*/ has a source')

  def test_hidden_modules(self):
    self.expect('src/model/joint.cc', '#include "chain.h"\n', 1,
                '"chain.h" hides its module')
    self.expect('src/model/joint.cc', '\n#include "../model/chain.h"\n', 2,
                '"../model/chain.h" hides its module')

  def test_libraries(self):
    for header in ('ceres/jet.h', 'yaml-cpp/yaml.h', 'nlohmann/json.hpp',
                   'tinyxml2.h', 'gflags/gflags.h'):
      self.expect('src/calibration/job.cc', f'#include <{header}>\n', 1,
                  f'calibration must not include {header}')

  def test_glog_is_hidden(self):
    self.expect('include/alidade/units.h', '#include <glog/logging.h>\n', 1,
                'a public header includes glog/logging.h')

  def test_mpi_is_in_one_file(self):
    self.expect('src/cli/run.cc', 'namespace alidade::internal {\n'
                'void H() { MPI_Init(); }\n}\n', 2,
                'MPI is used in one file alone, src/cli/mpi_communicator.cc')
    self.expect('src/cli/run.cc', '#include <mpi.h>\n', 1,
                'MPI is used in one file alone')

  def test_cycles(self):
    def expect(*places):
      found = self.check()
      for place in places:
        self.assertIn(f'{place}: components include each other', found)
      self.assertEqual(found.count('\n'), len(places), found)

    self.plant('src/kernel/a.h', '#include "src/kernel/b.h"\n')
    self.plant('src/kernel/b.cc', '\n#include "src/kernel/c.h"\n')
    self.plant('src/kernel/b.h', '')
    self.plant('src/kernel/c-inl.h', '#include "src/kernel/a.h"\n')
    self.plant('src/kernel/c.h', '')
    expect('src/kernel/a.h:1', 'src/kernel/b.cc:2', 'src/kernel/c-inl.h:1')
    (self.tree / 'src/kernel/a.h').unlink()
    # A public header is one with its source.
    self.plant('include/alidade/arm.h', '')
    self.plant('src/model/chain.h', '#include "alidade/arm.h"\n')
    expect('src/model/arm.cc:2', 'src/model/chain.h:1')

  def test_namespaces(self):
    message = 'is not in namespace alidade::internal'
    for text in ('namespace alidade {\nvoid F();\n}\n',
                 'namespace alidade {\nstruct A {};\n}\n',
                 'namespace alidade {\nnamespace {\nint f(int a) { }\n}}\n',
                 '\nusing A = int;\n'):
      line = 3 if 'namespace {' in text else 2
      self.expect('src/model/joint.h', text, line, message)
    # A source of a public header is one that includes it first.
    self.plant('src/model/joint.h', '')
    self.plant('src/model/joint.cc', '#include "alidade/arm.h"\n'
               'namespace alidade {\nvoid F() {}\n}\n')
    self.assertEqual(self.check(), '')
    # Others may define what such a header declares.
    self.expect('src/model/joint.cc', 'namespace alidade {\nvoid G() {}\n}\n',
                2, message)
    self.plant('include/alidade/arm.h', 'namespace alidade {\nvoid G();\n}\n')
    self.assertEqual(self.check(), '')
    self.expect('include/alidade/units.h', 'struct Unit {};\n', 1,
                'is not in namespace alidade:')

  def test_types_are_defined_once(self):
    text = ('namespace alidade::internal {\n'
            'template <int k = 1>\nvoid F(int a = 1) { G({}); }\n'
            'enum class Chain : int { k };\n}\n')
    message = ('alidade::internal::Chain is also defined in '
               'src/model/chain.h:3')
    self.expect('src/solve/progress.cc', text, 4, message)
    (self.tree / 'src/solve/progress.cc').unlink()
    self.expect('tests/solve/progress_test.cc', text, 4, message)
    (self.tree / 'tests/solve/progress_test.cc').unlink()
    # Tests of one module are one program.
    self.expect('tests/solve/progress_test.cc',
                CLEAN['tests/solve/arm_test.cc'], 2,
                'alidade::internal::Fixture is also defined in '
                'tests/solve/arm_test.cc:2')

  def test_functions_are_defined_once(self):
    compiler = shutil.which('c++') or self.skipTest('no compiler')
    objects = []
    for name, text in (('a', 'void F() {}'), ('b', 'void F(int) {}'),
                       ('c', 'namespace { void F() {} } void G() { F(); }')):
      self.plant(f'{name}.cc', text + ' inline void H() {} void (*I_' + name +
                 ')() = H;')
      objects.append(self.tree / f'{name}.o')
      subprocess.run([compiler, '-c', self.tree / f'{name}.cc', '-o',
                      objects[-1]], check=True)
    library = self.tree / 'libx.a'
    subprocess.run(['ar', 'rc', library, *objects], check=True)
    self.assertEqual(self.check(library), '')
    subprocess.run(['ar', 'rc', self.tree / 'liby.a', objects[0]], check=True)
    self.assertIn('liby.a:a.o: F() is also defined in libx.a:a.o',
                  self.check(library, self.tree / 'liby.a'))

  def test_studies_use_the_public_headers(self):
    path = 'studies/s/main.cc'
    self.plant(path, '#include <sys>\n#include <Eigen/QR>\n'
               '#include "alidade/arm.h"\n#include "studies/s/s.h"\n')
    self.assertEqual(self.check(), '')
    for header in ('"src/model/joint.h"', '<ceres/ceres.h>'):
      self.expect(path, f'\n#include {header}\n', 2,
                  f'a study must not include {header[1:-1]}')

  def test_lengths(self):
    for path in ('tests/model/long_test.cc', 'studies/s.py', 'src/report/p.js'):
      self.expect(path, '//\n' * 501, 501, '501 lines, at most 500')
      (self.tree / path).unlink()


if __name__ == '__main__':
  unittest.main()
