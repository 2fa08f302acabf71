"""Calibrations of made-up measurements, and what results hold."""

import json
import os
import pickle

import numpy as np
import pytest

import alidade
from conftest import DEVIATIONS, OPTIONS, frame, puma


def test_it_finds_the_real_arm(arm, real, result):
  q = arm.draw(200, seed=9)
  before = np.linalg.norm(arm.positions(q) - real.positions(q), axis=1)
  after = np.linalg.norm(result.arm.positions(q) - real.positions(q), axis=1)
  assert before.mean() > 1e-3
  assert after.mean() < 3e-5
  assert result.verdict.decision == 'accepted'
  assert result.validation.after.rms < 6e-5
  # Its own statement of how good that is.
  assert 0.3 < after.mean() / result.workspace.position_std.mean() < 2


def test_parameters_have_attributes(result):
  one = result['theta2']
  assert one.state == 'free' and one.unit == 'rad'
  assert abs(one.deviation - DEVIATIONS['theta2']) < 5 * one.std
  assert one.value == result.parameter('theta2').value
  assert 'theta2' in result.free
  index = result.free.index('theta2')
  assert result.covariance.shape == (len(result.free),) * 2
  assert result.covariance[index, index] == pytest.approx(one.std**2)
  with pytest.raises(alidade.InputError):
    result.parameter('theta7')
  with pytest.raises(AttributeError, match='verdict'):
    result.no_such_thing


def test_residuals_are_those_of_the_arm(result):
  train = result.train
  predicted = result.arm.positions(train.joint_values)
  np.testing.assert_allclose(train.residual_after,
                             predicted - train.positions, rtol=0, atol=1e-14)
  errors = np.linalg.norm(train.residual_after, axis=1)
  assert train.after.rms == pytest.approx(np.sqrt((errors**2).mean()))
  assert train.after.max == pytest.approx(errors.max())
  assert len(train.to_pandas()) == train.after.n
  assert train.to_pandas().after_error.max() == pytest.approx(errors.max())


def test_dict_frame_report_and_page(result):
  data = result.to_dict()
  assert data['parameters'][0]['name'] == 'beta1'
  assert json.dumps(data)
  frame_ = result.to_pandas()
  assert frame_.loc['d3', 'value'] == result['d3'].value
  assert 'theta2' in result.report()
  assert result.page().startswith('<!DOCTYPE html>')
  assert '<svg' in result._repr_html_() and 'rms' in result._repr_html_()
  figures = result.figures
  assert {'error_before', 'error_after', 'convergence'} <= set(figures)
  assert figures.error_after.svg.lstrip().startswith('<svg')


def test_svg_files_stand_alone(result, tmp_path):
  result.figures.convergence.save(tmp_path / 'convergence.svg')
  text = (tmp_path / 'convergence.svg').read_text()
  assert 'http://www.w3.org/2000/svg' in text


def test_saved_and_loaded(result, tmp_path):
  paths = result.save(tmp_path / 'r', page=True)
  assert any(name.endswith('report.html') for name in paths)
  again = alidade.Result.load(tmp_path / 'r')
  assert again.status == result.status and again.is_usable
  assert again.to_dict() == result.to_dict()
  np.testing.assert_allclose(again.train.residual_after,
                             result.train.residual_after, rtol=0, atol=1e-17)
  np.testing.assert_allclose(again.workspace.semi_axes,
                             result.workspace.semi_axes, rtol=1e-12)
  again.save(tmp_path / 'again')
  for name in ('result.json', 'residuals.csv', 'predicted_map.csv'):
    one = (tmp_path / 'r' / name).read_text()
    assert len((tmp_path / 'again' / name).read_text()) > 0.9 * len(one)
  q = result.arm.draw(5)
  np.testing.assert_allclose(again.arm.fk(q), result.arm.fk(q), rtol=0,
                             atol=1e-14)


def test_pickled(result, tmp_path):
  again = pickle.loads(pickle.dumps(result))
  assert again.to_dict() == result.to_dict()
  assert again.status == result.status and again.is_usable
  assert again.arm == result.arm
  for name in ('residual_before', 'residual_after', 'positions'):
    np.testing.assert_array_equal(again.train[name], result.train[name])
    np.testing.assert_array_equal(again.validation[name],
                                  result.validation[name])
  np.testing.assert_array_equal(again.workspace.position_std,
                                result.workspace.position_std)
  names = {os.path.basename(path) for path in result.save(tmp_path / 'one')}
  assert {os.path.basename(path)
          for path in again.save(tmp_path / 'other')} == names
  for name in names - {'validation_z_scores.svg'}:
    assert (tmp_path / 'one' / name).read_bytes() == (
        tmp_path / 'other' / name).read_bytes(), name


def test_sections_and_their_fields_say_the_same(arm, data):
  one = alidade.calibrate(arm, data, errors='none', loss='huber', fix=['d5'],
                          parameters=['joints', 'base', 'tool'])
  other = alidade.calibrate(
      arm, data, errors='none', robust={'loss': 'huber'}, threads=2,
      identifiability={'parameters': ['joints', 'base', 'tool'],
                       'fix': ['d5']})
  assert one.arm == other.arm
  assert one['d5'].state == 'fixed'


def test_without_a_sigma_it_is_estimated(arm, data):
  bare = alidade.Dataset(data.joint_values, data.positions)
  result = alidade.calibrate(arm, bare, **OPTIONS)
  assert result.fit.estimated_sigma == pytest.approx(2e-5, rel=0.2)


def test_other_validation_data_and_the_truth(arm, real, data):
  unseen = alidade.simulate(real, count=50, sigma=2e-5, seed=11)
  result = alidade.calibrate(arm, data, validation=unseen, truth=real,
                             **OPTIONS)
  assert result.validation.after.n == 50
  assert result['d2'].truth == pytest.approx(arm.parameters['d2'] + 8e-4)


def test_poses_with_orientations(arm, real):
  q = arm.draw(40, seed=12)
  data = alidade.Dataset(q, poses=real.fk(q), sigma=1e-5)
  result = alidade.calibrate(arm, data, **OPTIONS)
  # Priors pull a little.
  assert result.train.after.rms < 1e-8
  assert result.train.rotation_after.rms < 1e-8


def test_contacts_distances_and_differences(arm, real):
  q = arm.draw(120, seed=13)
  points = real.positions(q)
  anchor = np.array([2.0, 0.5, 0.3])
  pairs = np.arange(60)
  data = (alidade.Dataset(q)
          .with_distances('anchor', np.linalg.norm(points - anchor, axis=1),
                          1e-5, position=anchor, known=True)
          .with_differences(points[pairs] - points[pairs + 60], pairs,
                            pairs + 60, 1e-5))
  result = alidade.calibrate(arm, data, **OPTIONS)
  assert result.train.after.rms < 1e-7


def test_identify(arm, data):
  found = alidade.identify(arm, data, **OPTIONS)
  assert 'theta2' in found.free and found.num_free == len(found.free)
  assert any('dependent' in one.text for one in found.relations)
  assert 'theta2' in found.to_pandas().index
  assert found.report() and 'identifiable' in repr(found)


def test_options_are_documented():
  text = alidade.calibrate.__doc__
  for name in ('identifiability', 'max_iterations', 'confidence', 'loss',
               'default 50', '1 or more'):
    assert name in text
  assert '{options}' not in text
  # Python 3.13 strips the indentation of docstrings, earlier ones keep it: what
  # one of the two has must do.
  from alidade._options import with_options
  for written in ('One.\n\n    {options}\n    ', 'One.\n\n{options}\n'):
    shown = with_options(written, 'calibrate')
    assert '\nidentifiability : ' in shown
    assert '{options}' not in shown
  import inspect
  assert 'parameters' in inspect.signature(alidade.calibrate).parameters
  assert 'criterion' in alidade.plan.__doc__
  assert 'workspace_poses' in alidade.montecarlo.__doc__


def test_two_targets_of_one_arm(arm):
  two = alidade.Arm.parse(
      puma().to_yaml().split('tool:')[0].split('targets:')[0]
      + 'targets: [{name: a, x: 0.1}, {name: b, y: 0.2}]\n')
  q = two.draw(30)
  data = (alidade.Dataset(q)
          .with_positions(two.positions(q, target=0), 1e-5, target=0)
          .with_positions(two.positions(q, target=1), 1e-5, target=1))
  result = alidade.calibrate(two, data, errors='none')
  assert result.train.after.rms < 1e-9
  assert set(two.targets) == {'a', 'b'}
  assert np.allclose(frame(x=0.1), two.targets['a'])
