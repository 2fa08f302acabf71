"""Measurements from arrays, frames and files."""

import pickle

import numpy as np
import pandas
import pytest

import alidade
from conftest import ROOT

Q = np.random.default_rng(1).uniform(-1, 1, (40, 6))


def test_arrays_are_not_copied_where_rows_are_contiguous():
  points = np.random.default_rng(2).normal(size=(40, 3))
  data = alidade.Dataset(Q, points, sigma=1e-4)
  assert np.shares_memory(data.joint_values, Q)
  assert np.shares_memory(data.positions, points)
  wide = np.zeros((40, 9))
  assert np.shares_memory(alidade.Dataset(wide[:, 2:8]).joint_values, wide)
  assert not data.positions.flags.writeable


@pytest.mark.parametrize('same', [
    np.asfortranarray(Q), Q.tolist(), pandas.DataFrame(Q),
    np.repeat(Q, 3, axis=0)[::3], Q[::-1][::-1]])
def test_other_layouts_hold_the_same(same):
  np.testing.assert_array_equal(alidade.Dataset(same).joint_values, Q)


def test_integers_and_floats_of_32_bits_are_converted():
  assert alidade.Dataset(np.zeros((3, 2), dtype=int)).joint_values.dtype == (
      np.float64)
  np.testing.assert_array_equal(
      alidade.Dataset(Q.astype(np.float32)).joint_values,
      Q.astype(np.float32).astype(float))


def test_sigmas_of_all_shapes():
  points = np.zeros((40, 3))
  for sigma, expected in [
      (1e-3, np.full((40, 3), 1e-3)),
      ([1e-3, 2e-3, 3e-3], np.tile([1e-3, 2e-3, 3e-3], (40, 1))),
      (np.arange(1, 41), np.arange(1, 41)[:, None] * np.ones(3)),
      (np.arange(1, 121).reshape(40, 3), np.arange(1, 121).reshape(40, 3))]:
    data = alidade.Dataset(Q, points, sigma=sigma)
    np.testing.assert_array_equal(data.sigmas, expected)
    assert data.sigma_is_stated
  assert not alidade.Dataset(Q, points).sigma_is_stated


def test_a_coordinate_that_was_not_measured():
  data = alidade.Dataset(Q, np.zeros((40, 3)), sigma=[1e-3, 1e-3, np.inf])
  assert data.num_equations == 80


@pytest.mark.parametrize('ending', ['csv', 'npy'])
def test_files_keep_the_bits(arm, data, tmp_path, ending):
  data.save(tmp_path / f'set.{ending}', arm)
  again = alidade.Dataset.load(tmp_path / f'set.{ending}', arm, threads=2)
  np.testing.assert_array_equal(again.joint_values, data.joint_values)
  np.testing.assert_array_equal(again.positions, data.positions)
  np.testing.assert_array_equal(again.sigmas, data.sigmas)


def test_frames_are_read_as_files_are(arm):
  rv2aj = alidade.Arm.load(ROOT / 'configs/robots/rv2aj_flange.yaml')
  file = ROOT / 'datasets/rv2aj/flange_56.csv'
  frame = pandas.read_csv(file, comment='#', float_precision='round_trip')
  one = alidade.Dataset.from_pandas(frame, rv2aj, sigma=1e-4)
  other = alidade.Dataset.load(file, rv2aj, sigma=1e-4)
  # A frame's numbers are rounded before they are turned into m and rad.
  for name in ('joint_values', 'positions'):
    np.testing.assert_allclose(getattr(one, name), getattr(other, name),
                               rtol=4e-16)
  frame.loc[7, 'x_mm'] = np.inf
  with pytest.raises(alidade.InputError, match='row 7') as error:
    alidade.Dataset.from_pandas(frame, rv2aj, sigma=1e-4)
  assert error.value.key == "frame['x_mm']"


def test_orientations_as_matrices_vectors_and_poses(arm):
  poses = arm.fk(Q)
  one = alidade.Dataset(Q, poses=poses, sigma=1e-4)
  other = alidade.Dataset(Q, poses[:, :3, 3], rotations=poses[:, :3, :3],
                          sigma=1e-4)
  vectors = one._core.blocks()[0]['measured'][:, 3:]
  third = alidade.Dataset(Q, poses[:, :3, 3], rotations=vectors, sigma=1e-4,
                          sigma_rotation=1e-4 / 0.2)
  # Vectors are brought to half a turn at most: rounding.
  for same, rounding in ((other, 0.0), (third, 1e-15)):
    block, expected = same._core.blocks()[0], one._core.blocks()[0]
    np.testing.assert_allclose(block['measured'], expected['measured'],
                               rtol=0, atol=rounding)
    np.testing.assert_array_equal(block['sigmas'], expected['sigmas'])
  # Rodrigues' formula gives the matrices back.
  for vector, pose in zip(vectors, poses):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix = (np.eye(3) + np.sin(angle) * cross
              + (1 - np.cos(angle)) * cross @ cross)
    np.testing.assert_allclose(matrix, pose[:3, :3], rtol=0, atol=1e-14)


def test_half_turns():
  turns = np.array([np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]),
                    np.diag([-1.0, -1, 1]), np.eye(3)])
  data = alidade.Dataset(Q[:4], np.zeros((4, 3)), rotations=turns)
  vectors = data._core.blocks()[0]['measured'][:, 3:]
  np.testing.assert_allclose(np.abs(vectors), np.pi * np.vstack(
      [np.eye(3), np.zeros(3)]), rtol=0, atol=1e-15)


def all_kinds():
  return (alidade.Dataset(Q, name='all')
          .with_positions(np.ones((3, 3)), 1e-4, pose=[4, 5, 6])
          .with_distances('A', np.ones(40), 1e-4, position=[1, 2, 3])
          .with_point_contacts('socket', 1e-4, pose=[0, 1])
          .with_plane_contacts('floor', 1e-4, pose=[2, 3], offset=0.1)
          .with_differences(np.ones((2, 3)), [0, 1], [2, 3], 1e-4)
          .with_point_distances('A', 'socket', 0.4, 1e-5)
          .with_covariates(temperature=np.linspace(20, 25, 40)))


def test_every_kind_of_measurement_and_pickling():
  data = all_kinds()
  assert data.kinds == ['position', 'distance', 'fixed point', 'plane',
                        'difference', 'point distance']
  assert data.num_observations == 3 + 40 + 2 + 2 + 2 + 1
  assert data.num_equations == 9 + 40 + 6 + 2 + 6 + 1
  again = pickle.loads(pickle.dumps(data))
  one, other = data.__getstate__(), again.__getstate__()
  assert one['references'] == other['references']
  assert one['covariates'][0] == ['temperature']
  assert one['members'] == other['members']
  for block, same in zip(one['blocks'], other['blocks']):
    for key, value in block.items():
      np.testing.assert_array_equal(value, same[key])


def test_what_a_data_set_shows(data):
  assert '80 poses, 80 observations: position' in repr(data)
  assert list(data.to_pandas().columns)[-3:] == ['x', 'y', 'z']
  assert 'table' in data._repr_html_()
  assert len(data) == 80
