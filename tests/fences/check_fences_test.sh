#!/usr/bin/env bash
# Plants violations of the include fences in a small tree, one at a time, and
# expects check_fences.sh to find each, and to find nothing in the clean tree.
set -euo pipefail

check=$(cd "$(dirname "$0")" && pwd)/check_fences.sh
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

# plant FILE LINE...: writes a file of the tree.
plant() {
  mkdir -p "$tree/$(dirname "$1")"
  printf '%s\n' "${@:2}" >"$tree/$1"
}

clean_tree() {
  rm -rf "${tree:?}"/*
  plant include/alidade/base/error.h '#include <string>'
  plant include/alidade/model/arm.h '#include "alidade/base/error.h"'
  plant include/alidade/solve/options.h '#include <string>'
  plant src/io/reader.h '#include <yaml-cpp/yaml.h>'
  plant src/cli/mpi_communicator.cc '#include <mpi.h>' 'void F() { MPI_Finalize(); }'
  plant src/io/reader.cc '#include "src/io/reader.h"' '' \
    '#include <glog/logging.h>' '#include "alidade/solve/options.h"'
}

# expect_found TEXT: the check fails and says TEXT.
expect_found() {
  local output
  if output=$("$check" "$tree"); then
    echo "not found: $1"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* ]]; then
    echo "expected '$1', got: $output"
    failures=$((failures + 1))
  fi
}

# finds FILE TEXT LINE...: the file, planted in a clean tree, is found.
finds() {
  clean_tree
  plant "$1" "${@:3}"
  expect_found "$2"
}

clean_tree
if ! "$check" "$tree"; then
  echo "found something in a clean tree"
  failures=$((failures + 1))
fi

finds include/alidade/base/random.h \
  'include/alidade/base/random.h:2: module base must not include' \
  '#include <array>' '#include "alidade/model/arm.h"'
finds src/model/arm.cc \
  'src/model/arm.cc:1: module model must not include alidade/solve/options.h' \
  '#  include "alidade/solve/options.h"'
finds src/identifiability/rank.cc \
  'src/identifiability/rank.cc:1: module identifiability must not include' \
  '#include "alidade/solve/options.h"'
finds src/io/job_file.cc \
  'src/io/job_file.cc:1: module io must not include alidade/solve/problem.h' \
  '#include "alidade/solve/problem.h"'
finds src/report/figures.cc \
  'src/report/figures.cc:1: module report must not include alidade/model/arm.h' \
  '#include "alidade/model/arm.h"'
finds src/batch/job.cc \
  'src/batch/job.cc:1: src/io/reader.h is internal to module io' \
  '#include "src/io/reader.h"'
finds src/model/arm.cc \
  'src/model/arm.cc:1: ../io/reader.h hides its module' \
  '#include "../io/reader.h"'
finds src/io/writer.cc 'src/io/writer.cc:2: write "src/<module>/..."' \
  '#include <string>' '#include "reader.h"'
finds src/model/arm.cc \
  'src/model/arm.cc:1: module model must not include ceres/jet.h' \
  '#include <ceres/jet.h>'
finds src/batch/job.cc \
  'src/batch/job.cc:1: module batch must not include yaml-cpp/yaml.h' \
  '#include "yaml-cpp/yaml.h"'
finds src/batch/job.cc \
  'src/batch/job.cc:1: module batch must not include gflags/gflags.h' \
  '#include <gflags/gflags.h>'
finds src/batch/job.cc \
  'src/batch/job.cc:1: mpi.h may be included in src/cli/mpi_communicator.cc alone' \
  '#include <mpi.h>'
finds src/cli/main.cc 'src/cli/main.cc:2: MPI is used in src/cli/mpi_communicator.cc' \
  'int main() {' '  MPI_Finalize();' '}'
finds include/alidade/model/arm.h \
  'include/alidade/model/arm.h:1: public headers must not include glog' \
  '#include <glog/logging.h>'
finds src/extra/new.cc 'src/extra/new.cc:1: module extra is not in the table' \
  '#include <string>'

finds src/uncertainty/fit.cc \
  'src/uncertainty/fit.cc:1: module uncertainty must not include ceres' \
  '#include <ceres/ceres.h>'
finds src/compensation/inverse.cc \
  'src/compensation/inverse.cc:1: module compensation must not include' \
  '#include "alidade/results/accuracy.h"'

mapfile -t lines < <(seq -f '// %g' 600)
finds tests/model/arm_test.cc 'tests/model/arm_test.cc: 601 lines, at most 600' \
  "${lines[@]}" '// 601'
clean_tree
plant bench/study.cc "${lines[@]}"
if ! "$check" "$tree"; then
  echo "600 lines are too many"
  failures=$((failures + 1))
fi

clean_tree
plant include/alidade/base/a.h '#include "alidade/base/b.h"'
plant include/alidade/base/b.h '#include "alidade/base/a.h"'
expect_found 'include cycle'
clean_tree
plant src/io/a.h '#include "src/io/b.h"'
plant src/io/b.h '#include "src/io/a.h"'
expect_found 'include cycle'

if ((failures > 0)); then
  exit 1
fi
