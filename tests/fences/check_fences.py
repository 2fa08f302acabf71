#!/usr/bin/env python3
"""Checks the shape of the code: which module may include which, no cycles,
where other libraries may be used, one namespace, no name defined twice, and
no file that is too long. Prints file:line of each violation and what to do;
fails if there is any.

Usage: check_fences.py ROOT [LIBRARY...]
  ROOT      the tree that has include/alidade and src
  LIBRARY   static libraries built from it, in which no function of external
            linkage may be defined by two sources
"""

import collections
import pathlib
import re
import subprocess
import sys

# Each module and those that it may include; what these may include, it may
# as well.
ARROWS = {
    'common': '',
    'model': 'common',
    'data': 'model',
    'kernel': 'data',
    'error_terms': 'kernel',
    'identifiability': 'kernel',
    'initialization': 'identifiability',
    'solve': 'identifiability',
    'uncertainty': 'error_terms identifiability',
    'compensation': 'model',
    'calibration': 'initialization solve uncertainty',
    'planning': 'calibration',
    'simulation': 'calibration compensation',
    'dataio': 'data compensation',
    'serialization': 'planning simulation dataio',
    'report': 'planning simulation',
    'job': 'serialization report',
    'fleet': 'job',
    'cli': 'fleet',
}

# Modules of the public headers that have no source of their name; those of
# others are where src/*/NAME.cc is.
HEADER_ONLY = {
    'monte_carlo': 'simulation',
    'plan': 'planning',
    'rotation': 'model',
    'units': 'common',
    'workspace_box': 'model',
}

# Sources of a function of a public header whose types have a source of their
# own: what they are made of includes that header, so that no component is a
# circle.
FUNCTION_SOURCES = ('src/planning/planner.cc',
                    'src/simulation/run_monte_carlo.cc')

# How headers of other libraries begin, and the modules that may include them.
LIBRARIES = {
    'ceres/': 'kernel solve compensation',
    'yaml-cpp/': 'serialization dataio',
    'nlohmann/': 'serialization dataio',
    'tinyxml2.h': 'serialization dataio',
    'gflags/': 'cli',
}

LONGEST = 500  # lines of a file
LENGTH_FOLDERS = ('include', 'src', 'tests', 'bench', 'studies')
LENGTH_ENDINGS = ('.h', '.cc', '.js', '.py')

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
DIRECTIVE = re.compile(r'^[ \t]*#(?:[^\n\\]|\\.)*', re.MULTILINE | re.DOTALL)
TOKEN = re.compile(
    r'(?P<space>\s+|//[^\n]*|/\*.*?\*/)'
    r'|R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"'
    r"|'(?:\\.|[^'\\\n])+'|[A-Za-z_]\w*|\d[\w.']*|::|.", re.DOTALL)
TYPES = ('class', 'struct', 'union', 'enum')
BODY = '{}'  # in a statement: what its braces hold

# What a source defines or declares outside types and functions. `scope`: the
# namespaces that it is in, '' where one has no name; `name`: of a type that is
# defined, else ''.
Statement = collections.namedtuple('Statement', 'scope words name line')


def statements(text):
  """The Statements of a source; of several variables the first."""
  found = []
  scopes = []  # the names that each open namespace adds
  words = []
  line = first_line = 1
  braces = brackets = 0  # open ones: of a body that is passed over; ( and [
  for match in TOKEN.finditer(DIRECTIVE.sub(
      lambda m: '\n' * m.group().count('\n'), text)):
    token = match.group()
    line += token.count('\n')
    if match['space']:
      continue
    if braces:
      braces += (token == '{') - (token == '}')
      if not braces and not brackets and ends_with_body(words):
        words = []
      continue
    if not words:
      first_line = line
    brackets += (token in '([') - (token in ')]')
    ends = not brackets and token in '{;' and words and BODY not in words
    if ends and not (token == '{' and opens_namespace(words)):
      scope = tuple(name for names in scopes for name in names)
      name = type_name(words) if token == '{' else ''
      found.append(Statement(scope, words, name, first_line))
    if token == '{' and not brackets and opens_namespace(words):
      names = [word for word in words if word not in ('inline', '::')]
      scopes.append(names[1:] or [''])
      words = []
    elif token == '{':
      braces = 1
      words = words if brackets else words + [BODY]
    elif token == '}':
      scopes = scopes[:-1]
    elif token == ';' and not brackets:
      words = []
    else:
      words.append(token)
  return found


def opens_namespace(words):
  return words[:1] == ['namespace'] or words[:2] == ['inline', 'namespace']


def outline(words):
  """Without what is in <> and in parentheses, of which "(" is left."""
  left = []
  depth = 0
  for word in words:
    depth -= word in '>)]'
    if not depth and word not in ('>', ')', '<', '[', ']', 'template'):
      left.append(word)
    depth += word in '<(['
  return left


def ends_with_body(words):
  """Whether braces end the statement, as those of a function do; those of a
  type or a value are followed by a semicolon."""
  # A body behind initializers in braces, or one of these.
  if words[0] in (BODY, ',') or 'operator' in words:
    return True
  left = outline(words)
  return '(' in left and '=' not in left and not type_name(words)


def type_name(words):
  """Of a type that a statement before its braces defines, else ''."""
  left = [word for word in outline(words)
          if word not in ('typedef', 'static', 'inline', 'const', 'constexpr')]
  if not left or left[0] not in TYPES or '=' in left:
    return ''
  name = ''
  for i, word in enumerate(left[1:], 1):
    if word in (':', 'final', BODY):
      break
    if word == '(' and left[i - 1] != 'alignas':
      return ''
    if word not in ('class', 'struct', 'alignas', '('):
      name += word
  return name


class Tree:
  """The sources below a folder, and what is wrong with them."""

  def __init__(self, root):
    self.root = pathlib.Path(root)
    self.violations = []
    self.may_include = {}
    for module in ARROWS:
      self.may_include[module] = self._reachable(module)
    self.texts = self._read('include', 'src')
    self.owners = {}
    for path in self.texts:
      if path.startswith('src/') and path.endswith('.cc'):
        name = path.split('/')[-1][:-3]
        if f'include/alidade/{name}.h' in self.texts:
          self.owners[name] = path.split('/')[1]
    self.owners.update(HEADER_ONLY)
    # (file, line, brackets, header) of all.
    self.includes = [(path, number, *match.groups())
                     for path, text in self.texts.items()
                     for number, line in enumerate(text.split('\n'), 1)
                     for match in [INCLUDE.match(line)] if match]

  def _reachable(self, module):
    reachable = {module}
    for other in ARROWS[module].split():
      reachable |= self._reachable(other)
    return reachable

  def _read(self, *folders):
    paths = sorted(path for folder in folders
                   for path in (self.root / folder).rglob('*')
                   if path.suffix in ('.h', '.cc'))
    return {str(path.relative_to(self.root)): path.read_text()
            for path in paths}

  def violation(self, path, line, message):
    self.violations.append(f'{path}:{line}: {message}')

  def check(self):
    self.check_modules()
    self.check_arrows()
    self.check_libraries()
    self.check_mpi()
    self.check_cycles()
    self.check_names()
    self.check_studies()
    self.check_lengths()

  def module_of(self, path):
    """None of what has none."""
    parts = path.split('/')
    if parts[0] == 'src':
      return parts[1] if len(parts) > 2 and parts[1] in ARROWS else None
    return self.owners.get(parts[-1][:-2])

  def check_modules(self):
    for path in self.texts:
      if self.module_of(path):
        continue
      if path.startswith('src/'):
        self.violation(path, 1, 'is in no module: add it to ARROWS of '
                       'check_fences.py with those that it may include')
      else:
        self.violation(path, 1, 'no src/*/ has a source of this name: add '
                       'its module to HEADER_ONLY of check_fences.py')

  def check_arrows(self):
    for path, line, bracket, header in self.includes:
      module = self.module_of(path)
      if bracket == '"' and not re.match(r'(alidade|src)/[^/]', header):
        if '/' not in header or '../' in header:
          self.violation(path, line, f'"{header}" hides its module: write '
                         '"src/MODULE/..." or "alidade/..."')
        continue
      if bracket != '"' or not module:
        continue
      if header.startswith('src/') and path.startswith('include/'):
        self.violation(path, line, f'a public header includes {header}: '
                       'declare what it needs in include/alidade, or hide it '
                       'in the source')
        continue
      to = self.module_of(file_of(header))
      if to and to not in self.may_include[module]:
        self.violation(path, line, f'{module} must not include {header} of '
                       f'{to}: move what it needs to a module below both, or '
                       'this code above them')

  def check_libraries(self):
    for path, line, _, header in self.includes:
      module = self.module_of(path)
      for prefix, modules in LIBRARIES.items():
        if header.startswith(prefix) and module not in modules.split():
          self.violation(path, line, f'{module} must not include {header}: '
                         f'only {modules.replace(" ", ", ")} may; call these')
      if header.startswith('glog/') and path.startswith('include/'):
        self.violation(path, line, f'a public header includes {header}: log '
                       'in the source')

  def check_mpi(self):
    """The one file is the first that includes mpi.h."""
    owners = [path for path, _, _, header in self.includes
              if header == 'mpi.h']
    for path, text in self.texts.items():
      if owners and path == owners[0]:
        continue
      for number, line in enumerate(text.split('\n'), 1):
        if re.search(r'\bMPI_[A-Z]\w+|^\s*#\s*include\s*[<"]mpi\.h', line):
          self.violation(path, number, 'MPI is used in one file alone, '
                         f'{owners[0] if owners else "which includes mpi.h"}'
                         ': call the communicator')

  def component_of(self, path):
    """A header with its source, and with the fields of its structs."""
    name = re.sub(r'(-inl|_fields)?\.(h|cc)$', '', path.split('/')[-1])
    return f'{self.module_of(path)}/{name}'

  def check_cycles(self):
    edges = collections.defaultdict(dict)  # where one includes another
    for path, line, _, header in self.includes:
      target = file_of(header)
      one, other = self.component_of(path), self.component_of(target)
      if target in self.texts and one != other:
        edges[one].setdefault(other, (path, line))
    while cycle := shortest_cycle(edges):
      circle = ' -> '.join(cycle)
      for one, other in zip(cycle, cycle[1:]):
        self.violation(*edges[one].pop(other), 'components include each '
                       f'other in a circle, {circle}: move what they share '
                       'below both, or make them one')

  def check_names(self):
    """One namespace for what is not public, and one definition of a type
    among the sources that are linked into one program."""
    library = {}
    for path, text in self.texts.items():
      found = statements(text)
      self.check_namespaces(path, found)
      self.check_types(path, found, [library])
    tests = {path: statements(text)
             for path, text in self._read('tests').items()}
    support = {}
    programs = collections.defaultdict(dict)
    for path, found in tests.items():
      if path.startswith('tests/support/'):
        self.check_types(path, found, [support, library])
    for path, found in tests.items():
      if not path.startswith('tests/support/'):
        self.check_types(path, found,
                         [programs[path.split('/')[1]], support, library])

  def check_namespaces(self, path, found):
    wanted = ('alidade',) if self.is_public(path) else ('alidade', 'internal')
    for one in found:
      # main, and macros that stand outside.
      if not one.scope and (re.match('HWY_|DEFINE_', one.words[0]) or
                            one.words[:2] == ['int', 'main']):
        continue
      # Forward declarations of other libraries' types.
      if one.scope[:1] not in ((), ('alidade',)) and not one.name and (
          one.words[0] in TYPES):
        continue
      if one.scope == ('alidade',) and self.is_declared(path, one):
        continue
      if one.scope[:len(wanted)] != wanted:
        self.violation(path, one.line, f'is not in namespace '
                       f'{"::".join(wanted)}: move it there')

  def is_public(self, path):
    """Whether it is a public header or the source of one, which includes that
    before all others."""
    if path.startswith('include/') or path in FUNCTION_SOURCES:
      return True
    first = next((header for where, _, bracket, header in self.includes
                  if where == path and bracket == '"'), '')
    return (path.endswith('.cc') and first.startswith('alidade/') and
            self.module_of(file_of(first)) == self.module_of(path))

  def is_declared(self, path, statement):
    """Whether a public header of the module declares this function."""
    left = outline(statement.words)
    name = left[left.index('(') - 1] if '(' in left[1:] else ''
    return name.isidentifier() and any(
        re.search(rf'\b{name}\(', text) for other, text in self.texts.items()
        if other.startswith('include/') and
        self.module_of(other) == self.module_of(path))

  def check_types(self, path, found, programs):
    for one in found:
      if not one.name or '' in one.scope:
        continue
      name = '::'.join((*one.scope, one.name))
      for program in programs:
        if program.get(name, (path,))[0] != path:
          other = '{}:{}'.format(*program[name])
          self.violation(path, one.line, f'{name} is also defined in {other}, '
                         'and both may be in one program: rename one, or put '
                         'it into an anonymous namespace')
      programs[0].setdefault(name, (path, one.line))

  def check_studies(self):
    """Studies are clients as anybody's: they include the public headers, and of
    other libraries what these do."""
    for path, text in self._read('studies').items():
      for number, line in enumerate(text.split('\n'), 1):
        match = INCLUDE.match(line)
        if match and '/' in match[2] and not re.match(
            r'"(alidade|studies)/|<(Eigen/|glog/logging\.h)', ''.join(
                match.groups())):
          self.violation(path, number, f'a study must not include {match[2]}: '
                         'use the headers of include/alidade, or make public '
                         'what is missing there')

  def check_lengths(self):
    for folder in LENGTH_FOLDERS:
      for path in sorted((self.root / folder).rglob('*')):
        if path.suffix not in LENGTH_ENDINGS or not path.is_file():
          continue
        lines = path.read_text().count('\n')
        if lines > LONGEST:
          self.violation(path.relative_to(self.root), LONGEST + 1,
                         f'{lines} lines, at most {LONGEST}: split it by what '
                         'it owns')

  def check_symbols(self, libraries):
    """Functions and variables that two objects define: the linker takes either
    from static libraries without a word."""
    defined = {}
    for library in libraries:
      symbols = subprocess.run(
          ['nm', '--defined-only', '--print-file-name', library], check=True,
          stdout=subprocess.PIPE, text=True).stdout
      for line in symbols.splitlines():
        where, kind, symbol = line.rsplit(maxsplit=2)
        where = ':'.join(where.split('/')[-1].split(':')[:2])
        if kind in 'TDBR' and defined.setdefault(symbol, where) != where:
          self.violations.append(
              f'{where}: {demangled(symbol)} is also defined in '
              f'{defined[symbol]}: rename one, or put it into an anonymous '
              'namespace')


def demangled(symbol):
  return subprocess.run(['c++filt', symbol], check=True, text=True,
                        stdout=subprocess.PIPE).stdout.strip()


def file_of(header):
  return f'include/{header}' if header.startswith('alidade/') else header


def shortest_cycle(edges):
  """[a, b, a] of a graph, or None."""
  best = None
  for start in sorted(edges):
    paths = collections.deque([[start]])
    seen = set()
    while paths and not (best and len(paths[0]) >= len(best)):
      path = paths.popleft()
      for other in sorted(edges.get(path[-1], ())):
        if other == start:
          best = path + [start]
          paths.clear()
          break
        if other not in seen:
          seen.add(other)
          paths.append(path + [other])
  return best


def main():
  if len(sys.argv) < 2:
    sys.exit(__doc__)
  tree = Tree(sys.argv[1])
  tree.check()
  tree.check_symbols(sys.argv[2:])
  for violation in tree.violations:
    print(violation)
  if tree.violations:
    sys.exit(f'{len(tree.violations)} violations of the fences')


if __name__ == '__main__':
  main()
