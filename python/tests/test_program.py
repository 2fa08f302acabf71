"""The same bits as the program, for every job of configs; and its commands."""

import json
import os
import subprocess

import numpy as np
import pytest

import alidade
from conftest import DATA, PROGRAM, ROOT

JOBS = [path for folder in ('jobs', 'tutorials')
        for path in sorted((ROOT / 'configs' / folder).glob('*.yaml'))
        if 'format: alidade-job' in path.read_text()]
REAL = sorted((ROOT / 'configs/real_arms').glob('*.yaml'))
# Minutes with sanitizers.
if os.environ.get('ALIDADE_ALL_JOBS', '1') == '0':
  REAL = []


def without_times(value):
  """Nor what says who ran it."""
  if isinstance(value, dict):
    return {key: without_times(item) for key, item in value.items()
            if key not in ('times', 'command', 'threads_given',
                           'threads_used')
            and not key.endswith('time_s')}
  if isinstance(value, list):
    return [without_times(item) for item in value]
  return value


def run(*arguments):
  return subprocess.run([PROGRAM, *arguments], check=False,
                        capture_output=True, text=True)


@pytest.mark.parametrize('job', JOBS + REAL, ids=lambda job: job.stem)
def test_the_same_bits(job, tmp_path):
  if job in REAL and not DATA:
    pytest.skip('ALIDADE_DATA is not set')
  done = run('calibrate', job, f'--out={tmp_path}')
  if done.returncode not in (0, 1):
    with pytest.raises((alidade.CalibrationError, alidade.InputError)):
      alidade.calibrate(job)
    return
  result = alidade.calibrate(job)
  program = json.loads((tmp_path / 'result.json').read_text())
  assert without_times(result.to_dict()) == without_times(program)
  result.save(tmp_path / 'python')
  for name in ('arm.yaml', 'residuals.csv'):
    assert (tmp_path / name).read_bytes() == (
        tmp_path / 'python' / name).read_bytes()


def test_a_job_can_be_looked_at_and_changed():
  job = alidade.Job(ROOT / 'configs/jobs/rv2aj_flange.yaml')
  assert job.data.num_observations == 56 and job.arm.num_joints == 5
  assert len(job.validation) == 3600
  one = alidade.calibrate(job, max_iterations=1, check=False)
  assert one.runs[0].iterations == 1
  assert alidade.identify(job).num_free > 10
  assert 'RV-2AJ' in repr(job) and job.input_files


def test_simulations_are_those_of_the_program(tmp_path):
  file = ROOT / 'configs/simulations/rv2aj_flange_56.yaml'
  data = alidade.simulate(file)
  arm = alidade.Arm.load(ROOT / 'configs/robots/rv2aj_flange.yaml')
  assert run('simulate', file, f'--out={tmp_path}/set.csv').returncode == 0
  same = alidade.Dataset.load(tmp_path / 'set.csv', arm)
  np.testing.assert_array_equal(data.positions, same.positions)
  np.testing.assert_array_equal(data.joint_values, same.joint_values)


def test_batches(tmp_path):
  calls = []
  summary = alidade.batch(JOBS[:1], tmp_path / 'batch',
                          progress=lambda *state: calls.append(state))
  assert [one.status for one in summary.jobs] == ['done']
  assert calls[-1][:2] == (1, 1)
  assert (tmp_path / 'batch/summary.csv').exists()
