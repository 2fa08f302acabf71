#!/usr/bin/env bash
# Checks the include fences: who may include whom, and where outside libraries
# may be used; and that no source file is too long. Prints file:line of every
# violation; fails if there is any.
#
# Usage: check_fences.sh ROOT   (the tree that has include/alidade and src)
set -euo pipefail
cd "${1:?usage: check_fences.sh ROOT}"

# Each module, and the modules or single headers it may include besides itself.
declare -A may_include=(
  [base]=""
  [model]="base"
  [results]="base"
  [measurement]="base model results"
  [identifiability]="base model results measurement"
  [solve]="base model results measurement"
  [uncertainty]="base model results measurement identifiability"
  [design]="base model results measurement identifiability"
  [compensation]="base model"
  [io]="base model results measurement
    identifiability/options.h solve/options.h uncertainty/options.h
    design/options.h"
  [report]="base results"
  [batch]="base model results measurement identifiability solve uncertainty
    design compensation io report"
  [cli]="base model results measurement identifiability solve uncertainty
    design compensation io report batch"
)

# Each outside library's header prefix, and the modules that may include it.
declare -A allowed_in=(
  [ceres/]="measurement solve compensation"
  [tinyxml2.h]="io"
  [yaml-cpp/]="io"
  [gflags/]="cli"
)

# Lines of a source file, at most.
longest=600

# The one file that talks to MPI.
mpi_file=src/cli/mpi_communicator.cc

violations=0

# violation FILE:LINE MESSAGE
violation() {
  echo "$1: $2"
  violations=$((violations + 1))
}

# contains LIST WORD: whether the space-separated list has the word.
contains() {
  local word
  for word in $1; do
    [[ $word == "$2" ]] && return 0
  done
  return 1
}

# module_of PATH: "model" for include/alidade/model/arm.h and src/model/arm.cc.
module_of() {
  local path=${1#include/}
  path=${path#alidade/}
  path=${path#src/}
  echo "${path%%/*}"
}

# check_module WHERE FROM HEADER: an include of one of our own headers.
check_module() {
  local from=$2 header=$3
  local to
  to=$(module_of "$header")
  [[ $to == "$from" ]] && return
  if [[ $header == src/* ]]; then
    violation "$1" "$header is internal to module $to"
  elif ! contains "${may_include[$from]}" "$to" &&
    ! contains "${may_include[$from]}" "${header#alidade/}"; then
    violation "$1" "module $from must not include $header"
  fi
}

# check_outside WHERE FROM HEADER: an include of somebody else's header.
check_outside() {
  local prefix
  for prefix in "${!allowed_in[@]}"; do
    if [[ $3 == "$prefix"* ]] && ! contains "${allowed_in[$prefix]}" "$2"; then
      violation "$1" "module $2 must not include $3"
    fi
  done
  if [[ $3 == mpi.h && $1 != "$mpi_file":* ]]; then
    violation "$1" "$3 may be included in $mpi_file alone"
  fi
  if [[ $3 == glog/* && $1 == include/* ]]; then
    violation "$1" "public headers must not include $3"
  fi
}

# all_includes: every #include as "file:line header".
all_includes() {
  grep -rEn --include='*.h' --include='*.cc' '^[[:space:]]*#[[:space:]]*include' \
    include src |
    sed -nE 's/^([^:]+:[0-9]+):[^"<]*["<]([^">]+)[">].*/\1 \2/p'
}

# check_bare: our own headers by a name without its module, which hides cycles.
check_bare() {
  local where
  while read -r where; do
    violation "$where" "write \"src/<module>/...\": the name hides its module"
  done < <(grep -rEno --include='*.h' --include='*.cc' \
    '^[[:space:]]*#[[:space:]]*include[[:space:]]*"[^/"]+"' include src |
    cut -d: -f1,2)
}

# check_cycles: headers that include one another, which tsort calls a loop.
check_cycles() {
  local loop
  if ! loop=$(all_includes |
    sed -nE 's#^(include/)?([^ :]+\.h):[0-9]+ ((alidade|src)/.+)$#\2 \3#p' |
    tsort 2>&1 >/dev/null); then
    violation "include cycle" "${loop//$'\n'/ }"
  fi
}

# check_mpi_calls: names of MPI, which headers of ours might let through.
check_mpi_calls() {
  local where
  while read -r where; do
    violation "$where" "MPI is used in $mpi_file alone"
  done < <(grep -rEno --include='*.h' --include='*.cc' '\bMPI_[A-Z][A-Za-z_]+' \
    include src | grep -v "^$mpi_file:" | cut -d: -f1,2)
}

# check_lengths: source files of all folders, those without fences too.
check_lengths() {
  local lines file
  while read -r lines file; do
    if ((lines > longest)); then
      violation "$file" "$lines lines, at most $longest: split it"
    fi
  done < <(find include src tests bench -type f \
    \( -name '*.h' -o -name '*.cc' -o -name '*.js' -o -name '*.py' \) \
    -exec wc -l {} \; 2>/dev/null | sort -k2)
}

while read -r where header; do
  from=$(module_of "$where")
  if [[ ! -v may_include[$from] ]]; then
    violation "$where" "module $from is not in the table of $0"
  elif [[ $header == alidade/* || $header == src/* ]]; then
    check_module "$where" "$from" "$header"
  elif [[ $header == *../* ]]; then
    violation "$where" "$header hides its module: write src/<module>/..."
  else
    check_outside "$where" "$from" "$header"
  fi
done < <(all_includes)
check_bare
check_cycles
check_mpi_calls
check_lengths

if ((violations > 0)); then
  echo "$violations violations of the include fences"
  exit 1
fi
