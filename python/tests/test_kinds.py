"""Every kind of measurement that job files know, from arrays: the same numbers,
names and bits of the calibrated arm as those of a file and its job."""

import numpy as np
import pytest

import alidade
from alidade import Dataset
from conftest import puma

TARGETS = 'targets: [{name: probe, x: 0.05, z: 0.1}, {name: ball, y: 0.08}]\n'
YAML = puma().to_yaml().split('tool:')[0].split('targets:')[0] + TARGETS
ARM = alidade.Arm.parse(YAML)
REAL = ARM.with_deviations({'d2': 8e-4, 'theta2': 2e-3, 'r4': -6e-4})
N = 60
Q = 0.8 * ARM.draw(N, seed=1)
RNG = np.random.default_rng(2)
PROBE = REAL.positions(Q) + RNG.normal(0, 2e-5, (N, 3))
BALL = REAL.positions(Q, target=1) + RNG.normal(0, 2e-5, (N, 3))
POSES = REAL.fk(Q)
ROTATIONS = POSES[:, :3, :3]
S = RNG.uniform(1e-5, 5e-5, (N, 3))
A = RNG.uniform(1e-4, 5e-4, (N, 3))
FACTOR = RNG.normal(0, 3e-5, (N, 3, 3))
COVARIANCE = FACTOR @ FACTOR.transpose(0, 2, 1) + 1e-10 * np.eye(3)
SOCKETS = np.array([[0.5, 0.2, 0.3], [-0.4, 0.3, 0.5]])
NAMES = np.array(['A', 'B'])[np.arange(N) % 2]


def quaternions():
  """w, x, y, z by Shepperd's formula of the largest component."""
  found = []
  for m in ROTATIONS:
    four = np.array([1 + np.trace(m), *(1 + 2 * np.diag(m) - np.trace(m))])
    k = int(np.argmax(four))
    rows = np.array([
        [four[0], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], four[1], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0]],
        [m[0, 2] - m[2, 0], m[1, 0] + m[0, 1], four[2], m[2, 1] + m[1, 2]],
        [m[1, 0] - m[0, 1], m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], four[3]]])
    found.append(rows[k] / np.linalg.norm(rows[k]))
  return np.array(found)


def vectors():
  q = quaternions()
  q *= np.where(q[:, :1] < 0, -1, 1)
  sine = np.linalg.norm(q[:, 1:], axis=1, keepdims=True)
  return q[:, 1:] / sine * 2 * np.arctan2(sine, q[:, :1])


def zyx():
  """rx, ry, rz of Rot(z, rz) Rot(y, ry) Rot(x, rx)."""
  m = ROTATIONS
  return np.column_stack([np.arctan2(m[:, 2, 1], m[:, 2, 2]),
                          np.arcsin(-m[:, 2, 0]),
                          np.arctan2(m[:, 1, 0], m[:, 0, 0])])


def columns(*parts):
  """Joint values, then columns with their headers."""
  table = [[f'q{j + 1}_rad' for j in range(6)]
           + [name for names, _ in parts for name in names.split()]]
  for i in range(N):
    row = list(Q[i])
    for _, values in parts:
      row += list(np.atleast_1d(values[i]))
    table.append(['' if isinstance(x, float) and np.isnan(x) else
                  x if isinstance(x, str) else repr(float(x)) for x in row])
  return '\n'.join(','.join(map(str, row)) for row in table) + '\n'


XYZ = 'x_m y_m z_m'
AT_PROBE = 'target: probe'
RELATIVE = np.array([PROBE[(i + 1) % N] - PROBE[i] for i in range(N)])
FLAT = PROBE.copy()
FLAT[::3, 2] = np.nan
TEMPERATURE = 20 + 5 * np.sin(np.arange(N))
MASS = np.where(np.arange(N) % 3, 0.5, 4.0)
SIDES = np.where(np.sin(3 * np.arange(N)[:, None] + np.arange(6)) > 0, 1.0, -1)
DAYS = np.where(np.arange(N) < 30, 'monday', 'tuesday')
INVERSE = np.linalg.inv(POSES)


def flat():
  return Dataset(Q, np.nan_to_num(FLAT), sigma=np.where(
      np.isnan(FLAT), np.inf, 2e-5), target='probe')


def known_points():
  return (Dataset(Q).with_point('A', SOCKETS[0], known=True)
          .with_point('B').with_distances(
              NAMES, np.linalg.norm(PROBE - SOCKETS[np.arange(N) % 2], axis=1),
              2e-5, target='probe'))


def angles(**sigmas):
  return Dataset(Q, PROBE, rotations=zyx(), convention='intrinsic_zyx',
                 sigma=2e-5, target='probe', **sigmas)


KINDS = {
    # name: the file, the keys of the job, the same from arrays, options
    'position': (columns((XYZ, PROBE)), AT_PROBE,
                 lambda: Dataset(Q, PROBE, sigma=2e-5, target='probe')),
    'sigma of each': (
        columns((XYZ, PROBE), ('std_x_m std_y_m std_z_m', S)), AT_PROBE,
        lambda: Dataset(Q, PROBE, sigma=S, target='probe')),
    'an axis that was not measured': (columns((XYZ, FLAT)), AT_PROBE, flat),
    'covariance': (
        columns((XYZ, PROBE),
                ('cov_xx_m2 cov_xy_m2 cov_xz_m2 cov_yy_m2 cov_yz_m2 cov_zz_m2',
                 COVARIANCE[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]])),
        AT_PROBE,
        lambda: Dataset(Q, PROBE, covariance=COVARIANCE, target='probe')),
    'rotation vector': (
        columns((XYZ, PROBE), ('wx_rad wy_rad wz_rad', vectors())), AT_PROBE,
        lambda: Dataset(Q, PROBE, rotations=vectors(), sigma=2e-5,
                        target='probe')),
    'quaternion': (
        columns((XYZ, PROBE), ('qw qx qy qz', quaternions()),
                ('std_wx_rad std_wy_rad std_wz_rad', A)), AT_PROBE,
        lambda: Dataset(Q, PROBE, rotations=quaternions(), sigma=2e-5,
                        convention='quaternion', sigma_rotation=A,
                        target='probe')),
    'matrix': (
        columns((XYZ, PROBE), (' '.join(f'r{i}{j}' for i in (1, 2, 3)
                                        for j in (1, 2, 3)),
                               ROTATIONS.reshape(N, 9))), AT_PROBE,
        lambda: Dataset(Q, PROBE, rotations=ROTATIONS, sigma=2e-5,
                        target='probe')),
    'Euler angles': (
        columns((XYZ, PROBE), ('rx_rad ry_rad rz_rad', zyx())),
        AT_PROBE + '\n    rotation: intrinsic_zyx', angles),
    'sigmas of Euler angles': (
        columns((XYZ, PROBE), ('rx_rad ry_rad rz_rad', zyx()),
                ('std_rx_rad std_ry_rad std_rz_rad', A)),
        AT_PROBE + '\n    rotation: intrinsic_zyx',
        lambda: angles(sigma_angles=A)),
    'covariance beside an orientation': (
        columns((XYZ, PROBE), ('wx_rad wy_rad wz_rad', vectors()),
                ('cov_xx_m2 cov_xy_m2 cov_xz_m2 cov_yy_m2 cov_yz_m2 cov_zz_m2',
                 COVARIANCE[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]])),
        AT_PROBE,
        lambda: Dataset(Q, PROBE, rotations=vectors(), covariance=COVARIANCE,
                        sigma_rotation=2e-5 / 0.2, target='probe')),
    'inverse': (
        columns((XYZ, INVERSE[:, :3, 3]),
                (' '.join(f'r{i}{j}' for i in (1, 2, 3) for j in (1, 2, 3)),
                 INVERSE[:, :3, :3].reshape(N, 9))),
        AT_PROBE + '\n    inverse: true',
        lambda: Dataset(Q, poses=INVERSE, sigma=2e-5, inverse=True,
                        target='probe')),
    'distances from two points': (
        columns(('distance_m', np.linalg.norm(
            PROBE - SOCKETS[np.arange(N) % 2], axis=1)), ('point', NAMES)),
        AT_PROBE, known_points,
        f'references: {{points: [{{name: A, position: {SOCKETS[0].tolist()}, '
        'known: true}]}'),
    'a socket': (
        columns(('set', np.full(N, 'x'))), AT_PROBE + '\n    point: A',
        lambda: Dataset(Q).with_point_contacts('A', 2e-5, target='probe')),
    'a plane': (
        columns(('plane', np.full(N, 'table'))), AT_PROBE,
        lambda: Dataset(Q).with_plane_contacts('table', 2e-5, target='probe')),
    'differences': (
        columns(('dx_m dy_m dz_m', -RELATIVE),
                ('from', [str((i + 1) % N + 1) for i in range(N)])), AT_PROBE,
        lambda: Dataset(Q).with_differences(
            -RELATIVE, np.arange(N), (np.arange(N) + 1) % N, 2e-5,
            target='probe')),
    'a distance of two points': (
        columns((XYZ, PROBE), ('distance_m', np.linalg.norm(
            PROBE - SOCKETS[np.arange(N) % 2], axis=1)), ('point', NAMES)),
        AT_PROBE,
        lambda: (Dataset(Q, PROBE, sigma=2e-5, target='probe')
                 .with_distances(NAMES, np.linalg.norm(
                     PROBE - SOCKETS[np.arange(N) % 2], axis=1), 2e-5,
                                 target='probe')
                 .with_point_distances('A', 'B', 0.9, 1e-4)),
        'references: {distances: [{between: [A, B], distance: 0.9, '
        'sigma: 1.0e-4}]}'),
    'a target in each row': (
        columns((XYZ, np.where((np.arange(N) % 2)[:, None], BALL, PROBE)),
                ('target', np.array(['probe', 'ball'])[np.arange(N) % 2])),
        'rotation: ignore',
        lambda: Dataset(Q, np.where((np.arange(N) % 2)[:, None], BALL, PROBE),
                        sigma=2e-5,
                        target=np.array(['probe', 'ball'])[np.arange(N) % 2])),
    'two targets in one row': (
        columns((XYZ.replace('_', '1_'), PROBE), (XYZ.replace('_', '2_'),
                                                  BALL)),
        'columns: {targets: {probe: [x1_m, y1_m, z1_m], '
        'ball: [x2_m, y2_m, z2_m]}}',
        lambda: Dataset(Q).with_positions(
            np.stack([PROBE, BALL], axis=1).reshape(-1, 3), 2e-5,
            pose=np.repeat(np.arange(N), 2), target=['probe', 'ball'] * N)),
    'covariates': (
        columns((XYZ, PROBE), ('temperature', TEMPERATURE)),
        AT_PROBE + '\n    columns: {covariates: [temperature], effects: '
        '{temperature: [base, joint 2]}}',
        lambda: Dataset(Q, PROBE, sigma=2e-5, target='probe').with_covariates(
            temperature=TEMPERATURE,
            effects={'temperature': ['base', 'joint 2']}),
        'errors: {covariates: true}'),
    'payload': (
        columns((XYZ, PROBE), ('payload', MASS)),
        AT_PROBE + '\n    columns: {payload: payload}',
        lambda: Dataset(Q, PROBE, sigma=2e-5,
                        target='probe').with_payload(MASS),
        'errors: {elasticity: true}'),
    'one payload': (
        columns((XYZ, PROBE)), AT_PROBE + '\n    payload: 2.5',
        lambda: Dataset(Q, PROBE, sigma=2e-5,
                        target='probe').with_payload(2.5)),
    'approach': (
        columns((XYZ, PROBE), ('side', SIDES[:, 0])),
        AT_PROBE + '\n    columns: {approach: side}',
        lambda: Dataset(Q, PROBE, sigma=2e-5,
                        target='probe').with_approach(SIDES[:, 0]),
        'errors: {covariates: true}'),
    'approach of each joint': (
        columns((XYZ, PROBE), (' '.join(f's{j}' for j in range(6)), SIDES)),
        AT_PROBE + '\n    columns: {approach: [s0, s1, s2, s3, s4, s5]}',
        lambda: Dataset(Q, PROBE, sigma=2e-5,
                        target='probe').with_approach(SIDES),
        'errors: {covariates: true}'),
    'stations': (
        columns((XYZ, PROBE), ('day', DAYS)),
        AT_PROBE + '\n    columns: {station: day}',
        lambda: Dataset(Q, PROBE, sigma=2e-5,
                        target='probe').with_stations(DAYS)),
    'stations by lines': (
        columns((XYZ, PROBE)),
        AT_PROBE + '\n    stations: {monday: 2-31, tuesday: 32-}',
        lambda: Dataset(Q, PROBE, sigma=2e-5, target='probe').with_stations(
            ['monday'] * 30 + ['tuesday'] * (N - 30))),
}


def blocks_of(data):
  named = data._named(ARM, 'data') if data._core.target_names else data._core
  return named.blocks()


def assert_same(one, other, names=True):
  np.testing.assert_array_equal(one.joint_values, other.joint_values)
  assert one._core.references() == other._core.references()
  if names:
    assert list(one.covariates) == list(other.covariates)
    assert one._core.uses() == other._core.uses()
  for a, b in zip(one.covariates.values(), other.covariates.values()):
    np.testing.assert_array_equal(a, b)
  blocks = blocks_of(one), blocks_of(other)
  assert len(blocks[0]) == len(blocks[1])
  for a, b in zip(*blocks):
    for key, value in a.items():
      if key == 'whiteners':
        assert len(value) == len(b[key])
        for one_, other_ in zip(value, b[key]):
          np.testing.assert_array_equal(one_, other_)
      elif key == 'measured':
        # Of coordinates that were not measured nothing is said.
        was = np.isfinite(a['sigmas'])
        np.testing.assert_array_equal(value[was], b[key][was])
      else:
        np.testing.assert_array_equal(value, b[key], err_msg=key)


@pytest.fixture(params=KINDS)
def kind(request, tmp_path):
  """The job of a file, the file's keys, and the same from arrays."""
  csv, keys, make, *options = KINDS[request.param]
  (tmp_path / 'arm.yaml').write_text(YAML)
  (tmp_path / 'data.csv').write_text(csv)
  (tmp_path / 'job.yaml').write_text(
      'format: alidade-job-2\ntitle: t\nunits: {length: m, angle: rad}\n'
      'arm: arm.yaml\ndata:\n  - file: data.csv\n    ' + keys
      + '\nmeasurement: {sigma: 2.0e-5}\n'
      'identifiability: {parameters: [joints, base, tool]}\n'
      + '\n'.join(options if any('errors' in one for one in options)
                  else [*options, 'errors: none']) + '\n')
  return request.param, tmp_path / 'job.yaml', make


def test_the_same_bits_as_a_job(kind):
  name, file, make = kind
  job = alidade.Job(file)
  data = make()
  assert_same(data, job.data, names='approach' not in name)
  errors = 'none'
  for option in KINDS[name][3:]:
    if option.startswith('errors: {'):
      errors = {option[9:].split(':')[0]: True}
  options = dict(parameters=['joints', 'base', 'tool'], errors=errors,
                 check=False)
  one = alidade.calibrate(job, check=False)
  other = alidade.calibrate(job.arm, data, **options)
  assert one.status == other.status
  if one.is_usable:
    np.testing.assert_array_equal(one.train.residual_after,
                                  other.train.residual_after)
    assert one.arm.parameters == other.arm.parameters


def test_a_file_is_read_by_the_keys_of_a_job(kind):
  import yaml
  _, file, _ = kind
  text = yaml.safe_load(file.read_text())
  entry = text['data'][0]
  keys = {key: value for key, value in entry.items() if key != 'file'}
  data = Dataset.load(file.parent / 'data.csv', ARM, sigma=2e-5,
                      references=text.get('references'), **keys)
  assert_same(data, alidade.Job(file).data)
  assert data.sigma_is_stated


def test_pickled_measurements_calibrate_to_the_same_bits(kind):
  import pickle
  _, file, make = kind
  for data in (make(), alidade.Job(file).data):
    again = pickle.loads(pickle.dumps(data))
    assert_same(again, data)
    assert again._core.origin() == data._core.origin()
    assert again.rejected == data.rejected


def test_some_poses(kind):
  """As if no others had been measured."""
  _, _, make = kind
  data = make()
  odd = data[1::2]
  assert len(odd) == N // 2
  np.testing.assert_array_equal(odd.joint_values, data.joint_values[1::2])
  assert_same(data[np.arange(N)], data)
  assert_same(data[np.ones(N, dtype=bool)], data)
  shuffled = np.random.default_rng(3).permutation(N)
  back = data[shuffled][np.argsort(shuffled)]
  assert_same(back, data)


def test_all_keys_of_data_have_a_test():
  """Those of how a text is written are of files alone."""
  of_files = {'file', 'where', 'separator', 'decimal', 'thousands', 'header',
              'missing', 'exclude', 'sigma', 'rotation_sigma', 'plane'}
  of_columns = {'joints', 'position', 'orientation', 'std_position',
                'std_orientation', 'distance', 'std_distance', 'point', 'plane',
                'target', 'set', 'unit'}
  tried = ' '.join(' '.join(kind[1:2]) for kind in KINDS.values())
  for option in alidade._options.options_of('data'):
    if option['name'] not in of_files:
      assert option['name'] + ':' in tried, option['name']
    if option['name'] == 'columns':
      for field in option['fields']:
        if field['name'] not in of_columns:
          assert field['name'] + ':' in tried, field['name']


def test_two_data_sets_as_one(kind):
  """Both halves, apart and joined, are the whole."""
  name, _, make = kind
  data = make()
  half = data[:N // 2]
  joined = half + data[N // 2:]
  assert len(joined) == N and joined.points.keys() == data.points.keys()
  np.testing.assert_array_equal(joined.joint_values, data.joint_values)
  if name in ('differences', 'a distance of two points'):
    return  # Across both halves there is none, and this one is in both.
  assert joined.num_equations == data.num_equations
  options = dict(parameters=['joints', 'base', 'tool'], errors='none',
                 check=False)
  one = alidade.calibrate(ARM, data, **options)
  other = alidade.calibrate(ARM, joined, **options)
  # One socket determines little: rounding grows there.
  tolerance = 1e-4 if name == 'a socket' else 1e-9
  for key, value in one.arm.parameters.items():
    assert abs(other.arm.parameters[key] - value) < tolerance, key


def test_joined_data_sets_know_their_names():
  one = Dataset(Q[:3]).with_distances('A', np.ones(3), 1e-4, target='ball')
  two = (Dataset(Q[3:6]).with_point('B').with_point('A')
         .with_distances(['A', 'B', 'A'], np.ones(3), 1e-4, target='probe')
         .with_point_distances('B', 'A', 0.5, 1e-4)
         .with_differences(np.ones((1, 3)), [0], [2], 1e-4, target='ball'))
  both = one + two
  assert list(both.points) == ['A', 'B']
  blocks = both._named(ARM, 'data').blocks()
  assert [block['references'] for block in blocks] == [
      [0, 0, 0], [0, 1, 0], [1], []]
  assert [block['poses'] for block in blocks[:2]] == [[0, 1, 2], [3, 4, 5]]
  assert blocks[0]['targets'] == [1, 1, 1] and blocks[1]['targets'] == []
  assert blocks[2]['seconds'] == [0]
  assert (blocks[3]['poses'], blocks[3]['seconds']) == ([3], [5])
  for wrong in (Dataset(np.ones((2, 5))), Dataset(Q).with_payload(1.0)):
    with pytest.raises(alidade.InputError, match='other'):
      one + wrong
  with pytest.raises(TypeError):
    one + 3


def test_frames_with_units_in_their_headers():
  import pandas
  frame = pandas.DataFrame(np.degrees(Q),
                           columns=[f'q{j + 1}_deg' for j in range(6)])
  frame[['x_mm', 'y_mm', 'z_mm']] = 1e3 * PROBE
  data = Dataset.from_pandas(frame, ARM, target='probe', sigma=2e-5)
  np.testing.assert_allclose(data.joint_values, Q, rtol=1e-15)
  np.testing.assert_allclose(data.positions, PROBE, rtol=1e-15)
  own = frame.set_axis([*'abcdef', 'X', 'Y', 'Z'], axis=1)
  own['comment'] = 'of the day'
  same = Dataset.from_pandas(
      own, ARM, target='probe', sigma=2e-5,
      columns={'joints': list('abcdef'), 'position': ['X', 'Y', 'Z'],
               'unit': ['mm', 'deg']})
  np.testing.assert_array_equal(same.positions, data.positions)
  with pytest.raises(alidade.InputError, match='q1') as caught:
    Dataset.from_pandas(frame.rename(columns={'q1_deg': 'q1'}), ARM,
                        target='probe')
  assert 'q1_deg' in str(caught.value)


def test_validation_data_measure_against_the_same_names():
  lengths = np.linalg.norm(PROBE[:, None] - SOCKETS, axis=2)
  data = (Dataset(Q).with_point('A', SOCKETS[0], known=True)
          .with_point('B', SOCKETS[1] + 0.01)
          .with_distances('A', lengths[:, 0], 2e-5, target='probe')
          .with_distances('B', lengths[:, 1], 2e-5, target='probe'))
  options = dict(parameters=['joints', 'tool'], errors='none')
  # Of B alone, which is the first here.
  held = Dataset(Q[:9]).with_distances('B', lengths[:9, 1], 2e-5,
                                       target='probe')
  result = alidade.calibrate(ARM, data, validation=held, **options)
  assert result.validation.after.n == 9 and result.validation.after.max < 1e-4
  known = (Dataset(Q[:9]).with_point('C', SOCKETS[0] + [0, 0, 1], known=True)
           .with_distances('C', np.linalg.norm(
               PROBE[:9] - SOCKETS[0] - [0, 0, 1], axis=1), 2e-5,
                           target='probe'))
  result = alidade.calibrate(ARM, data, validation=known, **options)
  assert result.validation.after.max < 1e-4
  unknown = Dataset(Q[:9]).with_distances('D', lengths[:9, 0], 2e-5)
  with pytest.raises(alidade.InputError, match="validation.*'D'"):
    alidade.calibrate(ARM, data, validation=unknown, **options)


def test_stations_are_known_by_their_names(tmp_path):
  """Whichever comes first: in validation data, and in data that are joined."""
  moved = np.eye(4)
  moved[:3, 3] = 0.01, -0.02, 0.005
  turned = PROBE + moved[:3, 3]
  points = np.where((DAYS == 'tuesday')[:, None], turned, PROBE)
  data = Dataset(Q, points, sigma=2e-5, target='probe')
  whole = data.with_stations(DAYS)
  options = dict(parameters=['joints', 'base', 'tool'],
                 errors={'scale': True})
  tuesday = whole[DAYS == 'tuesday'][5:12]
  one_day = Dataset(tuesday.joint_values, tuesday.positions, sigma=2e-5,
                    target='probe').with_stations(['tuesday'] * 7)
  for held in (tuesday, one_day):
    result = alidade.calibrate(ARM, whole, validation=held, **options)
    assert result.validation.after.max < 2e-4
  elsewhere = data[:3].with_stations(['friday'] * 3)
  with pytest.raises(alidade.InputError, match="validation.*'friday'"):
    alidade.calibrate(ARM, whole, validation=elsewhere, **options)
  with pytest.raises(alidade.InputError, match='validation.*with_stations'):
    alidade.calibrate(ARM, whole, validation=data[:5], **options)
  joined = (data[DAYS == 'monday'].with_stations(['monday'] * 30)
            + data[DAYS == 'tuesday'].with_stations(['tuesday'] * 30))
  assert joined.covariates.keys() == whole.covariates.keys()
  for name, column in whole.covariates.items():
    np.testing.assert_array_equal(joined.covariates[name], column)
  assert joined._core.uses() == whole._core.uses()
  with pytest.raises(alidade.InputError, match='other.*with_stations'):
    whole + data
