#!/usr/bin/env bash
# scripts/insert_table replaces what is between two marks and nothing else, and
# leaves a page alone where something is wrong.
set -euo pipefail

insert=$(cd "$(dirname "$0")/../.." && pwd)/scripts/insert_table
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0

page() {
  printf '%s\n' before '<!-- few poses -->' '| old |' '| older |' \
    '<!-- end of few poses -->' between '<!-- other -->' '| kept |' \
    '<!-- end of other -->' >page.md
}

# refuses TEXT MARK FILE: fails, says TEXT, and the page is as it was.
refuses() {
  local output
  cp page.md before.md
  if output=$("$insert" page.md "${@:2}" 2>&1); then
    echo "not refused: ${*:2}"
    failures=$((failures + 1))
  elif [[ $output != *"$1"* ]] || ! cmp -s page.md before.md; then
    echo "expected '$1' and the page unchanged, got: $output"
    failures=$((failures + 1))
  fi
}

# A table may have what awk or the shell could read as something else.
printf '%s\n' '| a\nb & c |' '| %s | $HOME |' >table.md
for from in table.md -; do
  page
  "$insert" page.md "few poses" "$from" <table.md
  if ! diff page.md - <<'END'; then
before
<!-- few poses -->
| a\nb & c |
| %s | $HOME |
<!-- end of few poses -->
between
<!-- other -->
| kept |
<!-- end of other -->
END
    echo "wrong page from $from"
    failures=$((failures + 1))
  fi
done

page
: >empty.md
refuses 'empty.md is empty' other empty.md
refuses 'absent.md' other absent.md
refuses '0 lines <!-- none -->' none table.md
echo '<!-- other -->' >>page.md
refuses '2 lines <!-- other -->' other table.md
page
tac page.md >reversed.md
mv reversed.md page.md
refuses 'comes before its begin' other table.md

exit $((failures > 0))
