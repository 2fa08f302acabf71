"""Wrong input names the argument and what was expected; nothing crashes."""

import datetime

import numpy as np
import pandas
import pytest

import alidade
from conftest import ROOT, puma

ARM = puma()
Q = np.random.default_rng(1).uniform(-1, 1, (30, 6))
POINTS = ARM.positions(Q)
POSES = ARM.fk(Q)
DATA = alidade.Dataset(Q, POINTS, sigma=1e-4)
BAD = POINTS.copy()
BAD[4, 1] = np.nan
LEFT = POSES.copy()
LEFT[:, :3, 0] *= -1
SHEARED = POSES.copy()
SHEARED[:, 0, 0] += 0.1
PLAN = ROOT / 'configs/plans/rv2aj_flange.yaml'
JOB = ROOT / 'configs/jobs/rv2aj_flange.yaml'


def dataset(**changes):
  return lambda: alidade.Dataset(**{
      'joint_values': Q, 'positions': POINTS, 'sigma': 1e-4, **changes})


def calibrate(**changes):
  return lambda: alidade.calibrate(**{'arm': ARM, 'data': DATA, **changes})


def from_dh(**changes):
  return lambda: alidade.Arm.from_dh(**{'alpha': np.zeros(3), **changes})


WRONG = [
    # What is called, and the argument that the exception names.
    (dataset(joint_values=None), 'joint_values'),
    (dataset(joint_values='q'), 'joint_values'),
    (dataset(joint_values=Q[0]), 'joint_values'),
    (dataset(joint_values=Q[:, :, None]), 'joint_values'),
    (dataset(joint_values=np.empty((0, 6))), 'joint_values'),
    (dataset(joint_values=np.empty((30, 0))), 'joint_values'),
    (dataset(joint_values=Q + 1j), 'joint_values'),
    (dataset(joint_values=Q > 0), 'joint_values'),
    (dataset(joint_values=Q.astype(str)), 'joint_values'),
    (dataset(joint_values=Q.astype(object)), 'joint_values'),
    (dataset(joint_values=[[1, 2], [3]]), 'joint_values'),
    (dataset(joint_values=np.full((30, 6), np.inf)), 'joint_values'),
    (dataset(joint_values={'q': 1}), 'joint_values'),
    (dataset(joint_values=object()), 'joint_values'),
    (dataset(positions=BAD), 'positions'),
    (dataset(positions=POINTS.T), 'positions'),
    (dataset(positions=POINTS[:29]), 'positions'),
    (dataset(positions=POINTS[:, :2]), 'positions'),
    (dataset(positions=3), 'positions'),
    (dataset(positions=POINTS.astype('datetime64[s]')), 'positions'),
    (dataset(positions=None), 'sigma'),
    (dataset(poses=POSES), 'poses'),
    (dataset(positions=None, sigma=None, poses=POSES[:, :3]), 'poses'),
    (dataset(positions=None, sigma=None, poses=POSES.transpose(0, 2, 1)),
     'poses'),
    (dataset(positions=None, sigma=None, poses=LEFT), 'poses'),
    (dataset(positions=None, sigma=None, poses=SHEARED), 'poses'),
    (dataset(positions=None, sigma=None, poses=POSES[:3]), 'poses'),
    (dataset(positions=None, sigma=None, poses=POINTS), 'poses'),
    (dataset(rotations=POINTS[:4]), 'rotations'),
    (dataset(rotations=POSES), 'rotations'),
    (dataset(rotations=2 * POSES[:, :3, :3]), 'rotations'),
    (dataset(rotations=BAD), 'rotations'),
    (dataset(rotations='xyz'), 'rotations'),
    (dataset(sigma=0), 'sigma'),
    (dataset(sigma=-1e-3), 'sigma'),
    (dataset(sigma=np.nan), 'sigma'),
    (dataset(sigma='0.1 mm'), 'sigma'),
    (dataset(sigma=[1e-3, 1e-3]), 'sigma'),
    (dataset(sigma=np.ones((3, 30))), 'sigma'),
    (dataset(sigma=True), 'sigma'),
    (dataset(sigma_rotation=1e-3), 'sigma_rotation'),
    (dataset(rotations=np.zeros((30, 3)), sigma_rotation=0),
     'sigma_rotation'),
    (dataset(target=-1), 'target'),
    (dataset(target=1.5), 'target'),
    (dataset(target=''), 'target'),
    (dataset(target=None), 'target'),
    (dataset(target=['a', 'b']), 'target'),
    (calibrate(data=alidade.Dataset(Q, POINTS, target='wrist')), 'data'),
    (dataset(name=''), 'name'),
    (dataset(name=7), 'name'),
    (lambda: DATA.with_positions(POINTS[:2], pose=[0]), 'pose'),
    (lambda: DATA.with_positions(POINTS[:2], pose=[0, 30]), 'pose'),
    (lambda: DATA.with_positions(POINTS[:2], pose=[-1, 0]), 'pose'),
    (lambda: DATA.with_positions(POINTS[:2], pose=[0.0, 1.0]), 'pose'),
    (lambda: DATA.with_distances('', np.ones(30)), 'point'),
    (lambda: DATA.with_distances(None, np.ones(30)), 'point'),
    (lambda: DATA.with_distances('A', -np.ones(30)), 'lengths'),
    (lambda: DATA.with_distances('A', np.ones((30, 1))), 'lengths'),
    (lambda: DATA.with_distances('A', np.ones(29)), 'lengths'),
    (lambda: DATA.with_distances('A', np.ones(30), known=True), 'position'),
    (lambda: DATA.with_distances('A', np.ones(30), position=[1, 2]),
     'position'),
    (lambda: DATA.with_plane_contacts('P', normal=[0, 0, 0]), 'normal'),
    (lambda: DATA.with_plane_contacts('P', offset=np.nan), 'offset'),
    (lambda: DATA.with_plane_contacts('P', offset=[1, 2]), 'offset'),
    (lambda: DATA.with_differences(POINTS[:1], [0], [0]), 'second'),
    (lambda: DATA.with_differences(POINTS[:1], [0], [99]), 'second'),
    (lambda: DATA.with_point_distances('A', 'A', 1.0), 'second'),
    (lambda: DATA.with_point_distances('A', 'B', -1.0), 'length'),
    (lambda: DATA.with_covariates(), 'columns'),
    (lambda: DATA.with_covariates(load=[1, 2]), 'load'),
    (dataset(rotations=np.zeros((30, 4))), 'convention'),
    (dataset(rotations=np.full((30, 4), 0.6), convention='quaternion'),
     'rotations'),
    (dataset(rotations=np.zeros((30, 3)), convention='zyx'), 'convention'),
    (dataset(rotations=np.zeros((30, 3)), convention=3), 'convention'),
    (dataset(rotations=np.zeros((30, 3)), convention='quaternion'),
     'rotations'),
    (dataset(convention='intrinsic_zyx'), 'convention'),
    (dataset(inverse=True), 'inverse'),
    (dataset(sigma_angles=1e-3), 'sigma_angles'),
    (dataset(rotations=np.zeros((30, 3)), sigma_angles=1e-3), 'sigma_angles'),
    (dataset(rotations=np.zeros((30, 3)), sigma_angles=1e-3,
             sigma_rotation=1e-3), 'sigma_angles'),
    (dataset(positions=None, sigma=None, poses=POSES, convention='matrix'),
     'convention'),
    (dataset(covariance=np.eye(3)), 'covariance'),
    (dataset(sigma=None, covariance=-np.eye(3)), 'covariance'),
    (dataset(sigma=None, covariance=np.eye(6)), 'covariance'),
    (dataset(sigma=None, covariance=np.ones((29, 3, 3))), 'covariance'),
    (dataset(sigma=None, covariance=np.triu(np.ones((3, 3)))), 'covariance'),
    (dataset(sigma=None, covariance=np.full((3, 3), np.nan)), 'covariance'),
    (dataset(sigma=None, covariance='small'), 'covariance'),
    (dataset(sigma=None, covariance=np.eye(3), rotations=np.zeros((30, 3))),
     'sigma_rotation'),
    (dataset(sigma=None, covariance=np.eye(6), sigma_rotation=1e-3,
             rotations=np.zeros((30, 3))), 'sigma_rotation'),
    (dataset(target=64), 'target'),
    (dataset(target=[0] * 29), 'target'),
    (dataset(target=[0.5] * 30), 'target'),
    (lambda: DATA.with_point(''), 'name'),
    (lambda: DATA.with_point('A', [1, 2]), 'position'),
    (lambda: DATA.with_point('A', known=True), 'position'),
    (lambda: DATA.with_point('A').with_point('A'), 'name'),
    (lambda: DATA.with_plane('P', [0, 0, 0]), 'normal'),
    (lambda: DATA.with_plane('P').with_plane('P'), 'name'),
    (lambda: DATA.with_point('A').with_distances(
        'A', np.ones(30), position=[1, 2, 3]), 'position'),
    (lambda: DATA.with_distances(['A', 'B'], np.ones(30)), 'point'),
    (lambda: DATA.with_distances(['A'] * 29 + [3], np.ones(30)), 'point'),
    (lambda: DATA.with_plane_contacts(7), 'plane'),
    (lambda: DATA.with_covariates(load=np.ones(30), effects={'lod': 'base'}),
     'effects'),
    (lambda: DATA.with_covariates(load=np.ones(30), effects={'load': 'wrist'}),
     "effects['load']"),
    (lambda: DATA.with_covariates(load=np.ones(30), effects='base'),
     'effects'),
    (lambda: DATA.with_payload(1).with_payload(2), 'payload'),
    (lambda: DATA.with_payload(-1), 'mass'),
    (lambda: DATA.with_payload(np.ones(3)), 'mass'),
    (lambda: DATA.with_approach(np.full(30, 0.5)), 'directions'),
    (lambda: DATA.with_approach(np.ones((30, 5))), 'directions'),
    (lambda: DATA.with_stations('monday'), 'stations'),
    (lambda: DATA.with_stations(['a'] * 30).with_stations(['a'] * 30),
     'stations'),
    (lambda: DATA.with_stations(['a'] * 29), 'stations'),
    (lambda: DATA.with_stations([1] * 30), 'stations'),
    (lambda: DATA.with_stations(['a', 'b'] * 15, first=2), 'first'),
    (dataset(joint_values=np.ma.masked_greater(Q, 0.9)), 'joint_values'),
    (dataset(joint_values=pandas.DataFrame(
        Q, columns=[f'q{j}_deg' for j in range(1, 7)])), 'joint_values'),
    (dataset(positions=pandas.DataFrame(
        POINTS, columns=['x [mm]', 'y [mm]', 'z [mm]'])), 'positions'),
    (lambda: alidade.montecarlo(JOB, trials=5), 'trials'),
    (lambda: alidade.montecarlo(JOB, loss='huber'), 'loss'),
    (lambda: alidade.montecarlo(alidade.Job(JOB), los='huber'), 'los'),
    (lambda: alidade.plan(PLAN, sigma=1e-5), 'sigma'),
    (lambda: alidade.plan(PLAN, seed=3), 'seed'),
    (lambda: alidade.plan(PLAN, curve=[]), 'curve'),
    (lambda: alidade.simulate(ROOT / 'configs/simulations/rv2aj_wrist_56.yaml',
                              sigma=1e-5), 'sigma'),
    (lambda: DATA[[]], 'pose'),
    (lambda: DATA[[0, 0]], 'pose'),
    (lambda: DATA[30:], 'pose'),
    (lambda: DATA['first'], 'pose'),
    (lambda: DATA[np.ones(29, dtype=bool)], 'pose'),
    (lambda: DATA + alidade.Dataset(Q[:, :5]), 'other'),
    (lambda: alidade.Dataset.load('no.csv', ARM), None),
    (lambda: alidade.Dataset.load([], ARM), 'file'),
    (lambda: alidade.Dataset.load(['a.csv', None], ARM), 'file[1]'),
    (lambda: alidade.Dataset.load('no.csv', ARM, colums={}), 'colums'),
    (lambda: alidade.Dataset.load('no.csv', ARM, rotation='zyx'), 'rotation'),
    (lambda: alidade.Dataset.load('no.csv', ARM, target='ball'), 'target'),
    (lambda: alidade.Dataset.load('no.csv', ARM, payload=-1), 'payload'),
    (lambda: alidade.Dataset.load('no.csv', ARM, joints=['a']),
     'columns.joints'),
    (lambda: alidade.Dataset.load('no.csv', ARM, sigma=0), 'sigma'),
    (lambda: alidade.Dataset.load('no.csv', ARM, references={'pts': []}),
     'references.pts'),
    (lambda: alidade.Dataset.load(None, ARM), 'file'),
    (lambda: alidade.Dataset.load(JOB, ARM), None),
    (lambda: alidade.Dataset.load('no.csv', None), 'arm'),
    (lambda: alidade.Dataset.load('no.csv', ARM, threads=-1), 'threads'),
    (lambda: alidade.Dataset.from_pandas([1], ARM), 'frame'),
    (lambda: alidade.Arm(None), 'Arm'),
    (lambda: alidade.Arm.load('no.yaml'), None),
    (lambda: alidade.Arm.load(3), 'file'),
    (lambda: alidade.Arm.load('a\0b'), 'file'),
    (lambda: alidade.Arm.load(JOB), None),
    (lambda: alidade.Arm.parse('joints: ['), None),
    (lambda: alidade.Arm.parse(None), 'yaml'),
    (from_dh(convention='dh'), 'convention'),
    (from_dh(r=np.zeros(3)), 'r'),
    (from_dh(d=np.zeros(4)), 'd'),
    (from_dh(d=[0, 1, None]), 'd'),
    (from_dh(d=[0, 1, np.nan]), 'd'),
    (from_dh(alpha=None), 'alpha'),
    (from_dh(alpha=0.5), 'alpha'),
    (from_dh(alpha=[]), 'joints'),
    (from_dh(prismatic=[True]), 'prismatic'),
    (from_dh(prismatic='no'), 'prismatic'),
    (from_dh(limits=np.zeros((2, 3))), 'limits'),
    (from_dh(limits=[[1, -1]] * 3), 'joints[1].limits'),
    (from_dh(base=np.eye(3)), 'base'),
    (from_dh(tool=2 * np.eye(4)), 'tool'),
    (from_dh(name=''), 'name'),
    (lambda: alidade.Arm.from_urdf('no.urdf', 'a', 'b'), None),
    (lambda: alidade.Arm.from_urdf(JOB, 'a', 'b'), None),
    (lambda: alidade.Arm.from_urdf(JOB, None, 'b'), 'base_link'),
    (lambda: ARM.fk(Q[:, :5]), 'joint_values'),
    (lambda: ARM.fk(Q.T), 'joint_values'),
    (lambda: ARM.fk(None), 'joint_values'),
    (lambda: ARM.fk(Q, target=1), 'target'),
    (lambda: ARM.fk(Q, threads='all'), 'threads'),
    (lambda: ARM.jacobian(BAD), 'joint_values'),
    (lambda: ARM.ik(POINTS), 'poses'),
    (lambda: ARM.ik(POSES, Q[:3]), 'start'),
    (lambda: ARM.ik(POSES, task='orientation'), 'task'),
    (lambda: ARM.ik(POSES, trials=-1), 'trials'),
    (lambda: ARM.ik(POSES, seed=-1), 'seed'),
    (lambda: ARM.ik(POSES, max_joint_change=0), 'max_joint_change'),
    (lambda: ARM.draw(0), 'count'),
    (lambda: ARM.with_parameters({'d9': 1}), 'changes'),
    (lambda: ARM.with_parameters({'d3': 'long'}), "changes['d3']"),
    (lambda: ARM.with_parameters(None), 'changes'),
    (lambda: ARM.export('step'), 'format'),
    (lambda: ARM.export('dh', table='xls'), 'table'),
    (lambda: ARM.export('dh', nominal=3), 'nominal'),
    (calibrate(arm=None), 'arm'),
    (calibrate(arm=DATA), 'arm'),
    (calibrate(arm=ARM, data=None), 'data'),
    (calibrate(data=Q), 'data'),
    (calibrate(data=alidade.Dataset(Q)), 'data'),
    (calibrate(data=alidade.Dataset(Q[:, :5], POINTS)), 'data'),
    (calibrate(data=alidade.Dataset(Q, POINTS, target=2)), 'data'),
    (calibrate(validation=3), 'validation'),
    (calibrate(validation={'fraction': 2}), 'validation.fraction'),
    (calibrate(validation={'folds': 3, 'fraction': 0.5}), 'validation'),
    (calibrate(truth=puma(base=POSES[0])), 'truth'),
    (calibrate(threads=1.5), 'threads'),
    (calibrate(progress='yes'), 'progress'),
    (calibrate(parametres=['joints']), 'parametres'),
    (calibrate(parameters=['joint']), 'identifiability.parameters[1]'),
    (calibrate(parameters=3), 'identifiability.parameters'),
    (calibrate(fix=['d7']), 'identifiability.fix[1]'),
    (calibrate(identifiability=['joints']), 'identifiability'),
    (calibrate(identifiability={'polcy': 'keep'}), 'identifiability.polcy'),
    (calibrate(policy='free'), 'identifiability.policy'),
    (calibrate(loss='hubert'), 'robust.loss'),
    (calibrate(loss=1.0), 'robust.loss'),
    (calibrate(max_iterations=0), 'solver.max_iterations'),
    (calibrate(max_iterations=2.5), 'solver.max_iterations'),
    (calibrate(wanted_precision=-1), 'solver.wanted_precision'),
    (calibrate(confidence=95), 'uncertainty.confidence'),
    (calibrate(confidence=np.nan), 'uncertainty.confidence'),
    (calibrate(estimate_sigma='yes'), 'estimate_sigma'),
    (calibrate(bounds={'d3': [1]}), 'bounds.d3'),
    (calibrate(errors='some'), 'errors'),
    (calibrate(acceptance={'train_max': -1}), 'acceptance.train_max'),
    (calibrate(solver={'name': datetime.date(2020, 1, 1)}),
     'calibrate.solver.name'),
    (lambda: alidade.calibrate('no.yaml'), None),
    (lambda: alidade.calibrate(JOB, validation=DATA), 'validation'),
    (lambda: alidade.calibrate(JOB, truth=ARM), 'truth'),
    (lambda: alidade.identify(ARM), 'data'),
    (lambda: alidade.plan(ARM, poses=0, sigma=1e-3), 'poses'),
    (lambda: alidade.plan(ARM, poses=10), 'measurement'),
    (lambda: alidade.plan(ARM, poses=10, sigma=1e-3, candidates=Q[:, :2]),
     'candidates'),
    (lambda: alidade.plan(ARM, poses=10, sigma=1e-3, criterion='B'),
     'criterion'),
    (lambda: alidade.plan(ARM, poses=10, sigma=1e-3, measured=3), 'measured'),
    (lambda: alidade.simulate(ARM), 'joint_values'),
    (lambda: alidade.simulate(ARM, Q, count=3), 'count'),
    (lambda: alidade.simulate(ARM, Q, sigma=-1), 'sigma'),
    (lambda: alidade.montecarlo(ARM, DATA, trials=1), 'trials'),
    (lambda: alidade.montecarlo(ARM, DATA, study={'precision': 3}),
     'precision'),
    (lambda: alidade.correct(ARM, ARM), 'poses'),
    (lambda: alidade.correct(ARM, None, poses=POSES), 'real'),
    (lambda: alidade.correct(ARM, ARM, poses=POSES, joint_values=Q[:3]),
     'joint_values'),
    (lambda: alidade.compare('results'), 'results'),
    (lambda: alidade.compare([], kind='all'), 'kind'),
    (lambda: alidade.compare(['no'], kind='fleet'), None),
    (lambda: alidade.batch([], 'out'), 'files'),
    (lambda: alidade.batch('no.yaml', None), 'directory'),
    (lambda: alidade.Result.load('no/such'), None),
    (lambda: alidade.Job('no.yaml'), None),
]


@pytest.mark.parametrize('number', range(len(WRONG)))
def test_wrong_input(number):
  call, argument = WRONG[number]
  with pytest.raises(alidade.InputError) as caught:
    call()
  error = caught.value
  assert error.message
  if argument is not None:
    assert error.key == argument, str(error)
    assert argument in str(error)
    assert 'expected' in error.message or 'Expected' in error.message, error


def test_there_are_many():
  assert len(WRONG) >= 200


def test_errors_of_files_have_their_place(tmp_path):
  (tmp_path / 'arm.yaml').write_text(
      'format: alidade-arm-1\nname: a\nunits: {length: mm, angle: deg}\n'
      'joints:\n  - {type: revolute, lenght: 3}\n')
  with pytest.raises(alidade.InputError) as caught:
    alidade.Arm.load(tmp_path / 'arm.yaml')
  error = caught.value
  assert error.file.endswith('arm.yaml')
  assert (error.line, error.column) == (5, 22)
  assert error.key == 'joints[1].lenght'
  assert str(error).startswith(f'{error.file}:5:22: joints[1].lenght: ')


def test_a_misspelt_option_gets_its_name():
  with pytest.raises(alidade.InputError, match='did you mean "parameters"'):
    alidade.calibrate(ARM, DATA, parametres=['joints'])


def test_units_are_named():
  for joints, points, unit in ((Q, 1e3 * POINTS, 'mm'),
                               (np.degrees(Q), POINTS, 'deg')):
    with pytest.raises(alidade.InputError,
                       match=f'multiply by alidade.{unit}'):
      alidade.calibrate(ARM, alidade.Dataset(joints, points, sigma=1e-4),
                        parameters=['joints', 'base', 'tool'])


def test_an_unknown_frame_gets_a_hint():
  moved = alidade.Dataset(Q, POINTS + [2.0, -1.0, 0.5], sigma=1e-4)
  with pytest.raises(alidade.CalibrationError, match='"base", "tool"'):
    alidade.calibrate(ARM, moved)


def test_no_result_is_a_calibration_error():
  few = alidade.Dataset(Q[:2], POINTS[:2], sigma=1e-4)
  with pytest.raises(alidade.CalibrationError) as caught:
    alidade.calibrate(ARM, few, parameters=['joints', 'base', 'tool'],
                      policy='keep', errors='none')
  assert not caught.value.result.is_usable
  result = alidade.calibrate(ARM, few, parameters=['joints', 'base', 'tool'],
                             policy='keep', errors='none', check=False)
  assert result.message and result.status != 'done'
  assert 'Result' in repr(result)
