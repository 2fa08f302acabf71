"""The notebooks of examples: every cell runs and prints what the file shows.

ALIDADE_UPDATE=1 writes the outputs anew.
"""

import ast
import contextlib
import io
import json
import os

import numpy as np
import pytest

import alidade
from conftest import ROOT

EXAMPLES = sorted((ROOT / 'python/examples').glob('*.ipynb'))
# An output is shown as markup where it is no longer than this.
LONGEST = 60000


def run(source, names):
  """What a cell prints, and its last expression's value."""
  tree = ast.parse(source)
  last = None
  if tree.body and isinstance(tree.body[-1], ast.Expr):
    last = ast.Expression(tree.body.pop().value)
  printed = io.StringIO()
  value = None
  with contextlib.redirect_stdout(printed):
    exec(compile(tree, 'cell', 'exec'), names)
    if last is not None:
      value = eval(compile(last, 'cell', 'eval'), names)
  return printed.getvalue(), value


def outputs(printed, value, number):
  found = []
  if printed:
    found.append({'name': 'stdout', 'output_type': 'stream',
                  'text': printed.splitlines(keepends=True)})
  if value is not None:
    data = {'text/plain': repr(value).splitlines(keepends=True)}
    markup = getattr(value, '_repr_html_', lambda: None)()
    if markup and len(markup) <= LONGEST:
      data['text/html'] = markup.splitlines(keepends=True)
    found.append({'data': data, 'execution_count': number, 'metadata': {},
                  'output_type': 'execute_result'})
  return found


def text_of(output):
  return ''.join(output.get('text') or output['data']['text/plain'])


@pytest.mark.parametrize('file', EXAMPLES, ids=lambda file: file.stem)
def test_notebook(file, monkeypatch):
  monkeypatch.chdir(file.parent)
  notebook = json.loads(file.read_text())
  names = {'__name__': '__main__'}
  is_update = os.environ.get('ALIDADE_UPDATE') == '1'
  number = 0
  for cell in notebook['cells']:
    if cell['cell_type'] != 'code':
      continue
    number += 1
    found = outputs(*run(''.join(cell['source']), names), number)
    if is_update:
      cell['outputs'], cell['execution_count'] = found, number
    else:
      assert [text_of(one) for one in found] == [
          text_of(one) for one in cell['outputs']], ''.join(cell['source'])
  if is_update:
    file.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + '\n')
  assert number >= 4


def blocks_of(heading):
  """Blocks of code below a heading of docs/python.md."""
  guide = (ROOT / 'docs/python.md').read_text()
  section = guide.split(f'\n## {heading}\n')[1].split('\n## ')[0]
  return [block.split('```')[0] for block in section.split('```python\n')[1:]]


def test_the_guide(real, tmp_path, monkeypatch):
  """As a reader does it who copies one block after the other."""
  monkeypatch.chdir(tmp_path)
  simulated = alidade.simulate(real, count=60, sigma=2e-5)
  names = {'base_guess': np.eye(4), 'joint_values': simulated.joint_values,
           'positions': simulated.positions,
           'measure': lambda q: alidade.simulate(real, q, sigma=2e-5,
                                                 seed=5).positions}
  first, second = blocks_of('An own arm from arrays')
  exec(compile(first, 'docs/python.md', 'exec'), names)
  assert names['result'].validation.after.rms < 1e-4
  std = names['result'].workspace.position_std.mean()
  exec(compile(second, 'docs/python.md', 'exec'), names)
  assert names['plan'].joint_values.shape == (20, 6)
  assert names['result'].train.after.n == 80
  assert names['result'].workspace.position_std.mean() < 0.9 * std
  assert names['study'].estimates.shape[0] == 1000
  assert names['spring'].to_dict() == names['result'].to_dict()
  # The words that stand beside them.
  for options in ({'validation': {'folds': 5}}, {'max_iterations': 20},
                  {'policy': 'keep'}, {'fix': ['d2']},
                  {'bounds': {'d3': (-1e-3, 1e-3)}},
                  {'priors': {'theta': 2e-3}}):
    alidade.calibrate(names['arm'], names['data'], errors='none', check=False,
                      parameters=['joints', 'base', 'tool'], **options)
  # And SciPy's least squares, which knows nothing of the library's solver.
  names['scipy'] = pytest.importorskip('scipy')
  pytest.importorskip('scipy.optimize')
  _, usual, forward = blocks_of('Coming from scipy')
  exec(compile(usual, 'docs/python.md', 'exec'), {**names, 'sigma': 2e-5})
  exec(compile(forward, 'docs/python.md', 'exec'), names)
  stds = [names['result'][name].std for name in names['free']]
  off = np.abs(names['fit'].x - names['found']) / stds
  assert off.max() < 0.01, dict(zip(names['free'], off))


def test_there_are_three():
  assert len(EXAMPLES) == 3
