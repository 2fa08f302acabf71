"""Kinematics against matrices multiplied out in NumPy, and differences."""

import pickle

import numpy as np
import pytest

import alidade
from conftest import ROOT, frame, puma


def matrix(rotation, axis, length=0.0, along=2):
  """4 x 4: a rotation about an axis, then a shift along another."""
  c, s = np.cos(rotation), np.sin(rotation)
  i, j = [(1, 2), (2, 0), (0, 1)][axis]
  turn = np.eye(4)
  turn[i, i] = turn[j, j] = c
  turn[i, j], turn[j, i] = -s, s
  shift = np.eye(4)
  shift[along, 3] = length
  return turn @ shift


def standard_pose(a, d, alpha, q):
  pose = np.eye(4)
  for j in range(len(q)):
    pose = (pose @ matrix(q[j], 2, d[j], 2) @ matrix(0, 0, a[j], 0)
            @ matrix(alpha[j], 0))
  return pose


def khalil_pose(arm, q):
  g = arm.geometry
  pose = arm.base
  for j in range(arm.num_joints):
    slides = arm.joint_types[j] == 'prismatic'
    theta = g.theta[j] + (0 if slides else q[j])
    r = g.r[j] + (q[j] if slides else 0)
    pose = (pose @ matrix(g.beta[j], 1) @ matrix(g.alpha[j], 0)
            @ matrix(0, 0, g.d[j], 0) @ matrix(theta, 2, r, 2))
  return pose @ arm.tool


def test_standard_dh_is_the_product_of_its_matrices():
  rng = np.random.default_rng(1)
  a, d, alpha = rng.normal(size=(3, 6))
  arm = alidade.Arm.from_dh(a=a, d=d, alpha=alpha)
  q = rng.uniform(-3, 3, (20, 6))
  expected = [standard_pose(a, d, alpha, row) for row in q]
  np.testing.assert_allclose(arm.fk(q), expected, rtol=0, atol=1e-14)


def test_craig_dh_is_khalils_with_other_names():
  table = np.random.default_rng(2).normal(size=(4, 5))
  craig = alidade.Arm.from_dh(convention='craig', alpha=table[0], a=table[1],
                              theta=table[2], d=table[3])
  khalil = alidade.Arm.from_dh(convention='khalil', alpha=table[0],
                               d=table[1], theta=table[2], r=table[3])
  q = np.random.default_rng(3).normal(size=(4, 5))
  np.testing.assert_array_equal(craig.fk(q), khalil.fk(q))


def test_fk_with_base_tool_and_a_sliding_joint():
  rng = np.random.default_rng(4)
  arm = alidade.Arm.from_dh(
      convention='khalil', alpha=rng.normal(size=5), beta=rng.normal(size=5),
      d=rng.normal(size=5), theta=rng.normal(size=5), r=rng.normal(size=5),
      prismatic=[False, True, False, False, True],
      base=frame(1, 2, 3, 0.4), tool=frame(0.1, 0.2, 0.3, -1.0))
  q = rng.normal(size=(10, 5))
  expected = [khalil_pose(arm, row) for row in q]
  np.testing.assert_allclose(arm.fk(q), expected, rtol=0, atol=1e-14)
  np.testing.assert_allclose(arm.positions(q), arm.fk(q)[:, :3, 3],
                             rtol=0, atol=1e-15)
  assert arm.fk(q[0]).shape == (4, 4)


def test_threads_and_layouts_do_not_change_bits(arm):
  q = arm.draw(3000, seed=5)
  poses = arm.fk(q)
  for same in (q.astype(np.float64, order='F'), np.repeat(q, 2, axis=0)[::2],
               np.hstack([q, q])[:, :6], q[::-1][::-1]):
    np.testing.assert_array_equal(arm.fk(same, threads=3), poses)


def twist(one, other):
  """What leads from a pose to a near one."""
  turn = other[:3, :3] @ one[:3, :3].T
  return np.array([*(other - one)[:3, 3],
                   *(0.5 * np.array([turn[2, 1] - turn[1, 2],
                                     turn[0, 2] - turn[2, 0],
                                     turn[1, 0] - turn[0, 1]]))])


def test_jacobian_is_the_difference_of_poses(arm):
  step = 1e-6
  for q in arm.draw(5, seed=6):
    jacobian = arm.jacobian(q)
    for j, unit in enumerate(np.eye(6)):
      difference = twist(arm.fk(q - step * unit), arm.fk(q + step * unit))
      np.testing.assert_allclose(jacobian[:, j], difference / (2 * step),
                                 rtol=0, atol=1e-8)


def test_parameter_jacobian_is_the_difference_of_arms(arm):
  step = 1e-6
  q = arm.draw(4, seed=7)
  jacobians = arm.parameter_jacobian(q)
  values = arm.parameters
  assert jacobians.shape == (4, 6, len(values))
  for c, name in enumerate(values):
    near = [arm.with_parameters({name: values[name] + sign * step}).fk(q)
            for sign in (-1, 1)]
    difference = [twist(one, other) for one, other in zip(*near)]
    np.testing.assert_allclose(jacobians[:, :, c],
                               np.array(difference) / (2 * step), rtol=0,
                               atol=1e-8, err_msg=name)


def test_ik_reaches_what_fk_gives(arm):
  q = 0.8 * arm.draw(50, seed=8)
  poses = arm.fk(q)
  found = arm.ik(poses, q + 0.01)
  assert set(found.status) == {'reached'}
  np.testing.assert_allclose(arm.fk(found.joint_values), poses, rtol=0,
                             atol=1e-8)
  # Near a singular pose there are two.
  is_same = np.abs(found.joint_values - q).max(axis=1) < 1e-7
  assert is_same.mean() > 0.9
  free = arm.ik(poses, threads=2)
  reached = np.array(free.status) == 'reached'
  assert reached.mean() > 0.9
  np.testing.assert_allclose(arm.fk(free.joint_values)[reached],
                             poses[reached], rtol=0, atol=1e-8)


def test_ik_says_what_is_out_of_reach(arm):
  far = arm.base.copy()
  far[:3, 3] += 10
  assert arm.ik(far, trials=3).status[0] in ('out of reach', 'joint limit')


def test_arms_by_name(tmp_path, monkeypatch):
  arm = alidade.Arm.load('robots/ur10e')
  q = arm.draw(3, seed=1)
  file = alidade.Arm.load(ROOT / 'configs/robots/ur10e.yaml')
  assert np.array_equal(arm.fk(q), file.fk(q))
  with pytest.raises(alidade.InputError, match='did you mean'):
    alidade.Arm.load('robots/ur10f')
  # A file of one's own goes first.
  (tmp_path / 'robots').mkdir()
  puma().save(tmp_path / 'robots/ur10e')
  monkeypatch.chdir(tmp_path)
  assert alidade.Arm.load('robots/ur10e').name == puma().name


def test_a_file_and_pickling_keep_the_arm(arm, tmp_path):
  arm.save(tmp_path / 'arm.yaml')
  again = alidade.Arm.load(tmp_path / 'arm.yaml')
  q = arm.draw(10)
  np.testing.assert_allclose(again.fk(q), arm.fk(q), rtol=0, atol=1e-14)
  pickled = pickle.loads(pickle.dumps(arm))
  assert pickled == arm and hash(pickled) == hash(arm)
  np.testing.assert_array_equal(pickled.fk(q), arm.fk(q))


URDF = '''<robot name="two"><link name="a"/><link name="b"/><link name="c"/>
<joint name="first" type="revolute"><parent link="a"/><child link="b"/>
<origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="second" type="prismatic"><parent link="b"/><child link="c"/>
<origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.4" effort="1" velocity="1"/></joint></robot>'''


def test_urdf(tmp_path):
  (tmp_path / 'two.urdf').write_text(URDF)
  arm = alidade.Arm.from_urdf(tmp_path / 'two.urdf', 'a', 'c')
  assert arm.joint_types == ['revolute', 'prismatic']
  np.testing.assert_allclose(arm.limits, [[-2, 2], [0, 0.4]])
  np.testing.assert_allclose(arm.positions([0.5, 0.2]),
                             [0.5 * np.cos(0.5), 0.5 * np.sin(0.5), 0.5],
                             rtol=0, atol=1e-15)
  with pytest.raises(alidade.InputError, match='base_link|link'):
    alidade.Arm.from_urdf(tmp_path / 'two.urdf', 'x', 'c')


def test_every_arm_of_configs_loads():
  for file in (ROOT / 'configs/robots').glob('*.yaml'):
    if 'deviations' in file.name:
      continue
    arm = alidade.Arm.load(file)
    q = 0.1 * np.ones(arm.num_joints)
    np.testing.assert_allclose(arm.fk(q), khalil_pose(arm, q), rtol=0,
                               atol=1e-12)


def test_what_an_arm_shows(arm):
  assert repr(arm) == "Arm('puma', 6 joints)"
  assert 'revolute' in arm._repr_html_()
  assert list(arm.to_pandas().columns) == [
      'type', 'beta', 'alpha', 'd', 'theta', 'r', 'lower', 'upper']
  assert arm.parameter_units['d3'] == 'm'
  assert arm.with_parameters({'d3': 0.5}).parameters['d3'] == 0.5
  assert puma() != arm


PALLETISER = (
    'format: alidade-arm-1\nname: palletiser\nunits: {length: m, angle: rad}\n'
    'joints:\n  - {type: revolute, r: 0.5, limits: [-2, 2]}\n'
    '  - {type: revolute, alpha: -1.5707963267948966, limits: [-1, 1]}\n'
    '  - {type: revolute, d: 0.6, limits: [-1.2, 1.2]}\n'
    'motors: {matrix: [[-1, 0, 0], [0, 1, 0], [0, -1, 1]], '
    'offset: [0.1, 0, 0]}\ntool: {x: 0.4}\n')


def test_arms_whose_controller_counts_otherwise(tmp_path):
  arm = alidade.Arm.parse(PALLETISER)
  assert arm.has_motor_map and not puma().has_motor_map
  shown = np.random.default_rng(3).uniform(-0.5, 0.5, (40, 3))
  joints = arm.joints_from_motors(shown)
  np.testing.assert_allclose(joints, np.column_stack(
      [0.1 - shown[:, 0], shown[:, 1], shown[:, 2] - shown[:, 1]]), rtol=0,
                             atol=1e-16)
  np.testing.assert_allclose(arm.motors_from_joints(joints), shown, rtol=0,
                             atol=1e-15)
  np.testing.assert_array_equal(arm.joints_from_motors(shown[0]), joints[0])
  # Files hold what the controller shows.
  real = arm.with_deviations({'d3': 1e-3, 'theta2': 2e-3})
  data = alidade.simulate(real, joints, sigma=1e-5)
  data.save(tmp_path / 'set.csv', arm)
  assert (tmp_path / 'set.csv').read_text().startswith('q1_rad')
  first = (tmp_path / 'set.csv').read_text().splitlines()[1].split(',')
  assert abs(float(first[0]) - shown[0, 0]) < 1e-15
  again = alidade.Dataset.load(tmp_path / 'set.csv', arm)
  np.testing.assert_allclose(again.joint_values, joints, rtol=0, atol=1e-15)
  # Joint values go in and come out of corrections as everywhere.
  true = real.with_base(arm.base).with_tool(arm.tool)
  done = alidade.correct(arm, real, joint_values=joints, task='position')
  assert set(done.status) == {'reached'}
  np.testing.assert_allclose(true.positions(done.joint_values),
                             arm.positions(joints), rtol=0, atol=1e-8)
  np.testing.assert_allclose(done.asked_joints, joints, rtol=0, atol=1e-9)
  with pytest.raises(alidade.InputError, match='motors'):
    arm.joints_from_motors(shown[:, :2])
