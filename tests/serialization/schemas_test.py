#!/usr/bin/env python3
"""Checks that the schemas of schemas/ take every file of configs, and refuse
what is wrong.

Usage: schemas_test.py
Exit status: 77 where there is no jsonschema or yaml."""

import json
import pathlib
import re
import sys
import unittest

try:
  import jsonschema
  import yaml
except ImportError as error:
  print(error, file=sys.stderr)
  sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Loader(yaml.SafeLoader):
  """Reads 1e-8 as a number, as YAML 1.2 does."""


Loader.add_implicit_resolver(
    'tag:yaml.org,2002:float',
    re.compile(r'^[-+]?(\.\d+|\d+(\.\d*)?)([eE][-+]?\d+)?$'),
    list('-+.0123456789'))


def validator(name):
  schema = json.loads((ROOT / 'schemas' / f'{name}.json').read_text())
  jsonschema.Draft202012Validator.check_schema(schema)
  return jsonschema.Draft202012Validator(schema)


class SchemasTest(unittest.TestCase):

  def test_every_file_of_configs_is_valid(self):
    seen = set()
    for path in sorted((ROOT / 'configs').rglob('*.yaml')):
      content = yaml.load(path.read_text(), Loader)
      name = content['format'].split('-')[1]
      seen.add(name)
      with self.subTest(path=str(path)):
        errors = [f'{error.json_path}: {error.message}'
                  for error in validator(name).iter_errors(content)]
        self.assertEqual(errors, [])
    self.assertEqual(
        seen, {'arm', 'deviations', 'job', 'plan', 'simulation'})

  def test_what_is_wrong_is_refused(self):
    path = ROOT / 'configs/jobs/rv2aj_flange.yaml'
    content = yaml.load(path.read_text(), Loader)
    for change in ({'titel': 'x'}, {'data': 3}, {'solver': {'name': 'cere'}},
                   {'measurement': {'sigma': 0}},
                   {'solver': {'max_iterations': 0.5}},
                   {'data': {'file': 'a.csv', 'colums': {}}}):
      with self.subTest(change=change):
        self.assertFalse(validator('job').is_valid({**content, **change}))
    path = ROOT / 'configs/robots/rv2aj_wrist.yaml'
    arm = yaml.load(path.read_text(), Loader)
    for change in ({'base': {'x': '1 mm'}}, {'joints': [{'typ': 'revolute'}]},
                   {'joints': [{'type': 'revolute', 'sign': 2}]}):
      with self.subTest(change=change):
        self.assertFalse(validator('arm').is_valid({**arm, **change}))
    del content['title']
    self.assertFalse(validator('job').is_valid(content))
    self.assertTrue(validator('job').is_valid({**content, 'extends': 'a.yaml'}))


if __name__ == '__main__':
  unittest.main()
