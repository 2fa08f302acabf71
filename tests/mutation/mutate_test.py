#!/usr/bin/python3
"""Mutates a source of a few functions: what is found and what is left out, that
the woven source does what the plain one did until a mutant is chosen, that a
test of every value kills each mutant, and that one of few values does not.

Ends with 77, which ctest calls skipped, where libclang is not installed.
"""

import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import weave

try:
    import clang.cindex
except ImportError:
    sys.exit(77)

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "../.."))
EIGEN = "/usr/include/eigen3"
SOURCE = """#include <Eigen/Core>
#include <stdexcept>
#include <string>

constexpr int kUnits = 3;

constexpr int Doubled(int x) { return 2 * x; }

int Scalar(int x, bool flag) {
  constexpr int kLocal = 5;
  if (x == kLocal + 2) throw std::runtime_error("x" + std::to_string(x + 1));
  switch (x) {
    case 4:
      return kUnits;
    default:
      return x < 3 && !flag ? x * kUnits : -x;
  }
}

template <int kRows>
double Norm(const Eigen::Matrix<double, 3, 1>& v, double factor) {
  const Eigen::Vector3d sum = v + Eigen::Vector3d::Constant(factor);
  return (factor * sum - v).template head<2>().sum() / kRows;
}
"""
MAIN = """
#include <cstdlib>
int main(int count, char** arguments) {
  const bool is_strong = count > 1;
  if (Scalar(2, false) != 6) return 1;
  if (!is_strong) return 0;
  if (Scalar(3, false) != -3 || Scalar(2, true) != -2) return 1;
  if (Scalar(4, true) != 3) return 1;
  try {
    Scalar(7, false);
    return 1;
  } catch (const std::runtime_error&) {
  }
  return Norm<2>(Eigen::Vector3d(1.0, 2.0, 4.0), 3.0) == 12.0 ? 0 : 1;
}
"""
# Operators and numbers of SOURCE in their order.
EXPECTED = ["==", "+", "2", "<", "3", "&&", "!", "*", "-", "+", "*", "-", "/"]


class MutateTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "src/toy/toy.cc")
        os.makedirs(os.path.dirname(cls.path))
        with open(cls.path, "w") as file:
            file.write(SOURCE)
        unit = clang.cindex.Index.create().parse(
            cls.path, ["-std=c++17", "-isystem", EIGEN])
        collector = weave.Collector(os.path.realpath(cls.folder.name),
                                    "src/toy", clang.cindex)
        cls.sites = sorted(collector.collect(unit).values(),
                           key=lambda site: (site.line, site.column))
        mutants = [(number, site.forms[site.choices[-1]])
                   for number, site in enumerate(cls.sites, 1)]
        woven = weave.weave(SOURCE.encode(), mutants)
        cls.program = os.path.join(cls.folder.name, "toy")
        subprocess.run(
            ["g++", "-std=c++17", "-I", ROOT, "-isystem", EIGEN, "-x", "c++",
             "-", "-o", cls.program], input=woven + MAIN, text=True, check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def fails(self, number, *arguments):
        return subprocess.run(
            [self.program, *arguments],
            env={"ALIDADE_MUTANT": str(number)}).returncode != 0

    def test_finds_operators_and_numbers_of_bodies(self):
        self.assertEqual([site.old for site in self.sites], EXPECTED)

    def test_none_is_active_by_itself(self):
        self.assertFalse(self.fails(0, "strong"))

    def test_a_strong_test_kills_all(self):
        for number, site in enumerate(self.sites, 1):
            self.assertTrue(self.fails(number, "strong"), site)

    def test_a_weak_test_leaves_what_it_does_not_look_at(self):
        alive = [site.old for number, site in enumerate(self.sites, 1)
                 if not self.fails(number)]
        self.assertEqual(
            alive, ["+", "2", "&&", "-", "+", "*", "-", "/"])


if __name__ == "__main__":
    unittest.main()
