#!/usr/bin/env bash
# bench/compare_results.py finds what differs by more than is allowed, and nothing
# else.
set -euo pipefail

compare=$(cd "$(dirname "$0")/../.." && pwd)/bench/compare_results.py
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

# results AGE: those of a calibration of two parameters, one of them estimated.
results() {
  local folder=$work/$1/job/calibrate
  rm -rf "${work:?}/$1"
  mkdir -p "$folder"
  echo 'calibrate: 0' >"$work/$1/job/statuses.yaml"
  printf '%s\n' 'name: "arm"' 'joints:' '  - type: revolute  # joint 1' \
    '    d: 0.25  # 250 mm' '    r: 0.0013  # 1.3 mm' >"$folder/arm.yaml"
  printf '%s\n' pose,after_error_mm,time_s 1,0.5,3 2,1e-11,4 >"$folder/residuals.csv"
  cat >"$folder/result.json" <<'END'
{"parameters": [{"name": "d1", "value": 0.001, "std": 1e-05, "state": "free"},
                {"name": "r1", "value": 0.0013, "std": null, "state": "fixed"}],
 "accuracy": {"train": {"after": {"max": 0.01}}},
 "fit": {"sigma": 2e-05, "estimated_rotation_sigma": 0},
 "uncertainty": {"parameters": [{"name": "d1"}], "covariance": [[1e-10]]},
 "solver": {"name": "ceres", "status": "converged", "iterations": 4},
 "warnings": ["one thing"]}
END
}

# compares WITH FILE OLD NEW: what is to be said when NEW is put in place of OLD.
compares() {
  local output
  results new
  sed -i "s/$3/$4/" "$work/new/job/$2"
  output=$("$compare" "$work" job) || true
  if [[ $output != *"$1"* ]]; then
    echo "$2, $3 -> $4: expected '$1', got: $output"
    failures=$((failures + 1))
  fi
}

results old
result=calibrate/result.json none=": 0 differences"
compares "$none" $result none none
compares "$none" $result 0.001, 0.001000000009,
compares "parameters[d1]/value: 0.001" $result 0.001, 0.00100000002,
compares "parameters[r1]/value" $result 0.0013 0.001300000003
compares "covariance[0][0]" $result 1e-10 1.00001e-10
compares "parameters[d1]/state: free -> fixed" $result free fixed
compares "solver/status: converged -> missing" $result '"status"' '"state"'
compares "only new: uncertainty" $result '"covariance"' '"more": 1, "covariance"'
compares "$none" $result 'iterations": 4' 'iterations": 9'
compares "$none" $result converged rounding_floor
compares "solver/status" $result converged failed
compares "other text: warnings[] (1)" $result 'one thing' 'another thing'
compares "warnings: 1 entries -> 2 entries" $result 'thing"' 'thing", "another"'
compares "parameters[r1]: " $result '"r1"' '"r2"'
compares "d1: 0.25 -> 0.2500001" calibrate/arm.yaml 0.25 0.2500001
compares "[0]/after_error" calibrate/residuals.csv 0.5 0.5000001
compares "$none" calibrate/residuals.csv 0.5,3 0.50000001,7
compares "$none" calibrate/residuals.csv 1e-11 7e-10
compares "calibrate: 0 -> 3" statuses.yaml 0 3

# What the study's own program writes beside a result is a part of it.
results old
sed -i 's/"warnings"/"study": {"amount": 4e-07}, &/' "$work/old/job/$result"
compares "study: {'amount': 4e-07} -> missing" $result none none
results new
echo '{"amount": 4e-07}' >"$work/new/job/calibrate/study.json"
"$compare" "$work" job | grep -q "$none" || {
  echo "study.json was not taken for a part of the result"
  failures=$((failures + 1))
}

results old
results new
rm "$work/new/job/calibrate/arm.yaml"
if "$compare" "$work" job >"$work/output" || ! grep -q missing "$work/output"; then
  echo "a missing file was not found"
  failures=$((failures + 1))
fi

exit $((failures > 0))
