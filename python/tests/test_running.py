"""Threads, Ctrl-C, callbacks, memory."""

import concurrent.futures
import os
import resource
import signal
import threading
import time

import numpy as np
import pytest

import alidade
from conftest import OPTIONS, ROOT

IS_QUICK = os.environ.get('ALIDADE_ALL_JOBS', '1') == '0'


def test_eight_threads_at_once_get_the_same_bits(arm, data):
  def calibrate(_):
    return alidade.calibrate(arm, data, threads=1, **OPTIONS).arm

  with concurrent.futures.ThreadPoolExecutor(8) as pool:
    arms = list(pool.map(calibrate, range(8)))
  assert all(one == arms[0] for one in arms)


def test_others_run_while_the_library_works(arm):
  q = arm.draw(200000)
  counts = []
  done = threading.Event()

  def count():
    while not done.is_set():
      counts.append(1)
      time.sleep(0.001)

  other = threading.Thread(target=count)
  other.start()
  begin = time.monotonic()
  arm.fk(q)
  seconds = time.monotonic() - begin
  done.set()
  other.join()
  assert len(counts) > 20 * seconds


def many(real):
  return alidade.simulate(real, count=3000, sigma=2e-5, seed=1)


def test_ctrl_c_ends_a_long_study(arm, data):
  timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
  timer.start()
  begin = time.monotonic()
  with pytest.raises(KeyboardInterrupt):
    alidade.montecarlo(arm, data, trials=10**7, threads=2, **OPTIONS)
  assert time.monotonic() - begin < 20
  # And the next call works.
  assert alidade.calibrate(arm, data, **OPTIONS).is_usable


def test_ctrl_c_ends_a_calibration(arm, real):
  data = many(real)
  calls = []

  def interrupt(*state):
    calls.append(state)
    if len(calls) == 2:
      os.kill(os.getpid(), signal.SIGINT)

  with pytest.raises(KeyboardInterrupt):
    alidade.calibrate(arm, data, progress=interrupt,
                      folds=20, **OPTIONS)


def long_calls(arm, real, data):
  """What takes seconds or longer, by name."""
  q = np.tile(arm.draw(100000, seed=1), (40, 1))
  few = q[:200000]
  poses = arm.fk(few, threads=2)
  return {
      'draw': lambda: [arm.draw(4 * 10**6, seed=1) for _ in range(3)],
      'fk': lambda: arm.fk(q),
      'positions': lambda: [arm.positions(q) for _ in range(5)],
      'jacobian': lambda: arm.jacobian(q),
      'parameter_jacobian': lambda: arm.parameter_jacobian(q[:800000]),
      'ik of each': lambda: arm.ik(poses, few),
      'ik': lambda: arm.ik(poses),
      'correct': lambda: alidade.correct(arm, real, joint_values=few),
      'simulate': lambda: alidade.simulate(real, q, sigma=1e-5),
      'plan': lambda: alidade.plan(
          arm, poses=150, sigma=2e-5, candidates={'count': 40000},
          parameters=['joints', 'base', 'tool']),
      'error terms': lambda: alidade.calibrate(
          arm, data, parameters=['joints', 'base', 'tool'], folds=20),
  }


@pytest.mark.skipif(IS_QUICK, reason='minutes with sanitizers')
def test_ctrl_c_ends_whatever_is_long(arm, real):
  for name, call in long_calls(arm, real, many(real)).items():
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
      timer.start()
      call()
      # On a fast machine it is done by now.
      timer.join()
      time.sleep(0.1)
    assert time.monotonic() - begin < 20, name


def test_progress_and_what_it_raises(arm, data):
  calls = []
  alidade.calibrate(arm, data, progress=lambda *state: calls.append(state),
                    **OPTIONS)
  assert calls[0][0] == 0 and calls[-1][1] < calls[0][1]

  def fail(*_):
    raise RuntimeError('enough')

  with pytest.raises(RuntimeError, match='enough'):
    alidade.calibrate(arm, data, progress=fail, **OPTIONS)
  with pytest.raises(RuntimeError, match='enough'):
    alidade.montecarlo(arm, data, trials=10**7, progress=fail, **OPTIONS)


def resident():
  with open('/proc/self/statm', encoding='ascii') as file:
    return int(file.read().split()[1]) * resource.getpagesize()


@pytest.mark.skipif(IS_QUICK, reason='sanitizers keep freed memory')
def test_no_leak(arm):
  q = arm.draw(20)
  poses = arm.fk(q)

  def call():
    arm.fk(q)
    arm.jacobian(q)
    alidade.Dataset(q, poses=poses, covariance=1e-8 * np.eye(6),
                    target='a').with_point('A', [1, 2, 3])[::2].positions
    arm.ik(poses[:1], q[:1])
    try:
      arm.fk(q[:, :3])
    except alidade.InputError:
      pass

  for _ in range(2000):
    call()
  before = resident()
  for _ in range(100000 // 5):  # of five calls each
    call()
  assert resident() - before < 2e6


def test_arrays_outlive_what_they_come_from(arm, data):
  result = alidade.calibrate(arm, data, **OPTIONS)
  residuals = result.train.residual_after
  covariance = result.covariance
  copies = residuals.copy(), covariance.copy()
  del result
  alidade.calibrate(arm, data, **OPTIONS)
  np.testing.assert_array_equal(residuals, copies[0])
  np.testing.assert_array_equal(covariance, copies[1])
  joints = alidade.Dataset(np.ones((5, 6))).joint_values
  np.testing.assert_array_equal(joints, np.ones((5, 6)))


def test_ctrl_c_ends_a_batch(tmp_path):
  finished = []

  def interrupt(*state):
    finished.append(state)
    if len(finished) == 3:
      os.kill(os.getpid(), signal.SIGINT)

  with pytest.raises(KeyboardInterrupt):
    alidade.batch(ROOT / 'configs/batches/rv2aj_1000.yaml', tmp_path,
                  threads=2, progress=interrupt)
  assert len(finished) < 900
