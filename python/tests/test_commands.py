"""Plans, studies, corrections, exports, comparisons."""

import os
import pickle

import numpy as np
import pytest

import alidade
from conftest import OPTIONS, ROOT


def test_a_plan_is_better_than_random_poses(arm):
  plan = alidade.plan(arm, poses=25, sigma=2e-5, candidates={'count': 400},
                      parameters=['joints', 'base', 'tool'], seed=2,
                      curve=[])
  assert plan.joint_values.shape == (25, 6) and len(plan) == 25
  worst = {one.name: one.candidates.worst for one in plan.evaluations}
  assert plan.evaluations[0].candidates.worst == min(worst.values())
  assert plan.pose_std.shape == (25,)
  assert list(plan.to_pandas().columns)[-1] == 'pose_std'
  assert 'mm' in plan.report() and plan.criterion == 'D'


def test_a_plan_chooses_of_given_candidates_beside_what_is_measured(arm, data):
  candidates = arm.draw(100, seed=4)
  plan = alidade.plan(arm, poses=5, sigma=2e-5, measured=data, curve=[],
                      parameters=['joints', 'base', 'tool'],
                      candidates=candidates)
  for row in plan.joint_values:
    assert (candidates == row).all(axis=1).any()
  assert plan.measured_before == 80


def test_files_of_a_plan(arm, tmp_path):
  plan = alidade.plan(arm, poses=20, sigma=2e-5, candidates={'count': 200})
  plan.save(tmp_path)
  assert (tmp_path / 'poses.csv').exists()
  assert '<svg' in plan.figures.accuracy.svg
  assert '<svg' in plan._repr_html_()


def test_plans_studies_and_jobs_can_be_pickled(arm, data, tmp_path):
  plan = alidade.plan(arm, poses=15, sigma=2e-5, curve=[],
                      candidates={'count': 60})
  study = alidade.montecarlo(arm, data, trials=5, **OPTIONS)
  for k, one in enumerate((plan, study)):
    again = pickle.loads(pickle.dumps(one))
    assert again.to_dict() == one.to_dict()
    assert again.report() == one.report() and repr(again) == repr(one)
    assert again.figures.keys() == one.figures.keys()
    assert [name for name in map(os.path.basename,
                                 again.save(tmp_path / f'again{k}'))] == [
        name for name in map(os.path.basename, one.save(tmp_path / f'{k}'))]
    for file in (tmp_path / f'{k}').glob('[!.]*'):
      assert file.read_bytes() == (
          tmp_path / f'again{k}' / file.name).read_bytes()
    twice = pickle.loads(pickle.dumps(again))
    assert twice.to_dict() == one.to_dict()
  np.testing.assert_array_equal(
      pickle.loads(pickle.dumps(plan)).joint_values, plan.joint_values)
  np.testing.assert_array_equal(
      pickle.loads(pickle.dumps(study)).estimates, study.estimates)
  job = alidade.Job(ROOT / 'configs/jobs/rv2aj_flange.yaml')
  assert repr(pickle.loads(pickle.dumps(job))) == repr(job)


def test_a_study_of_a_job_takes_keywords():
  job = alidade.Job(ROOT / 'configs/jobs/rv2aj_flange.yaml')
  study = alidade.montecarlo(job, trials=3, fix=['d3'])
  assert len(study.estimates) == 3 and 'd3' not in study.names


def test_monte_carlo(arm, data, real):
  calls = []
  study = alidade.montecarlo(arm, data, trials=40, truth=real, seed=5,
                             study={'workspace_poses': 50},
                             progress=lambda *state: calls.append(state),
                             **OPTIONS)
  assert study.estimates.shape == (40, len(study.names))
  index = study.names.index('theta2')
  spread = study.estimates[:, index].std(ddof=1)
  assert study.parameters[index].spread == pytest.approx(spread)
  assert study.axes.rate > 0.85
  assert study.workspace_rms.mean() == pytest.approx(study.workspace.mean)
  assert calls[-1] == (40, 40)
  again = alidade.montecarlo(arm, data, trials=40, truth=real, seed=5,
                             study={'workspace_poses': 50}, threads=2,
                             **OPTIONS)
  np.testing.assert_array_equal(again.estimates, study.estimates)
  assert study.to_pandas().coverage.between(0, 1).all()
  assert study.report() and '<svg' in study._repr_html_()


def test_corrected_targets_are_reached(arm, real):
  # The controller's frames: those of the nominal arm.
  true = real.with_base(arm.base).with_tool(arm.tool)
  # Away from singular poses, where postures meet.
  q = 0.7 * arm.draw(60, seed=6)
  q = q[np.linalg.svd(arm.jacobian(q), compute_uv=False)[:, -1] > 0.05]
  assert len(q) > 20
  targets = arm.fk(q)
  done = alidade.correct(arm, real, poses=targets, joint_values=q)
  assert set(done.status) == {'reached'}
  np.testing.assert_allclose(true.fk(done.joint_values), targets, rtol=0,
                             atol=1e-8)
  np.testing.assert_allclose(arm.fk(done.joint_values), done.poses, rtol=0,
                             atol=1e-12)
  same = alidade.correct(arm, real, joint_values=q)
  np.testing.assert_allclose(same.joint_values, done.joint_values, rtol=0,
                             atol=1e-9)
  back = alidade.correct(arm, real, joint_values=done.joint_values,
                         inverse=True)
  np.testing.assert_allclose(back.joint_values, q, rtol=0, atol=1e-8)


def test_a_result_corrects_as_its_arm_does(arm, result):
  q = 0.5 * arm.draw(5)
  one = alidade.correct(arm, result, joint_values=q)
  other = alidade.correct(arm, result.arm, joint_values=q)
  np.testing.assert_array_equal(one.joint_values, other.joint_values)


def test_exports(arm, result):
  exported = alidade.export(result, 'mdh', nominal=arm)
  assert 'alpha' in exported.text and exported.max < 1e-3
  assert alidade.export(arm, 'json').text.startswith('{')
  assert 'joint' in alidade.export(arm, 'dh', table='latex').text or True


def test_comparisons(arm, real, result, tmp_path):
  later = alidade.simulate(real.with_deviations({'theta3': 2e-3}), count=80,
                           sigma=2e-5, seed=8)
  second = alidade.calibrate(arm, later, **OPTIONS)
  result.save(tmp_path)
  drift = alidade.compare([tmp_path, second], kind='time',
                          labels=['May', 'June'])
  changed = [one.name for one in drift.changes if one.is_significant]
  assert changed[0] == 'theta3'
  assert alidade.compare([result, second]).is_small
  assert len(alidade.compare([result, second], kind='methods').ranking) == 2
