"""Times of the Python package: forward kinematics beside what calibrators in
NumPy do, and calibrations beside the library's own time. Prints Markdown."""

import os
import sys
import time

import numpy as np

import alidade


def best(call, repeats):
  """Smallest of some times (s) of this process: others may run beside it."""
  times = []
  for _ in range(repeats):
    begin = time.process_time()
    call()
    times.append(time.process_time() - begin)
  return min(times)


A = np.array([0, 0.4318, -0.0203, 0, 0, 0])
D = np.array([0.672, 0, 0.15005, 0.4318, 0, 0.056])
ALPHA = np.radians([90, 0, -90, 90, -90, 0])


def loop_fk(joints):
  """A product of 4 x 4 matrices for each joint of each pose."""
  poses = np.empty((len(joints), 4, 4))
  for i, q in enumerate(joints):
    pose = np.eye(4)
    for j in range(6):
      c, s = np.cos(q[j]), np.sin(q[j])
      ca, sa = np.cos(ALPHA[j]), np.sin(ALPHA[j])
      pose = pose @ np.array([[c, -s * ca, s * sa, A[j] * c],
                              [s, c * ca, -c * sa, A[j] * s],
                              [0, sa, ca, D[j]], [0, 0, 0, 1]])
    poses[i] = pose
  return poses


def vectorised_fk(joints):
  """The same for all poses at once."""
  count = len(joints)
  poses = np.broadcast_to(np.eye(4), (count, 4, 4))
  cosines, sines = np.cos(joints), np.sin(joints)
  for j in range(6):
    c, s = cosines[:, j], sines[:, j]
    ca, sa = np.cos(ALPHA[j]), np.sin(ALPHA[j])
    step = np.zeros((count, 4, 4))
    step[:, 0, 0], step[:, 0, 1], step[:, 0, 2] = c, -s * ca, s * sa
    step[:, 1, 0], step[:, 1, 1], step[:, 1, 2] = s, c * ca, -c * sa
    step[:, 0, 3], step[:, 1, 3] = A[j] * c, A[j] * s
    step[:, 2, 1], step[:, 2, 2], step[:, 2, 3] = sa, ca, D[j]
    step[:, 3, 3] = 1
    poses = poses @ step
  return poses


def kinematics():
  arm = alidade.Arm.from_dh(a=A, d=D, alpha=ALPHA)
  joints = np.random.default_rng(1).uniform(-3, 3, (1000000, 6))
  few = joints[:5000]
  assert np.abs(arm.fk(few) - loop_fk(few)).max() < 1e-13
  assert np.abs(arm.fk(few) - vectorised_fk(few)).max() < 1e-13
  ours = best(lambda: arm.fk(joints, threads=1), 3)
  rows = [('`arm.fk`, 1e6 poses, one thread', ours, 1.0),
          ('`arm.positions`, one thread',
           best(lambda: arm.positions(joints, threads=1), 3), None),
          ('`arm.jacobian`, one thread',
           best(lambda: arm.jacobian(joints, threads=1), 2), None),
          ('NumPy, vectorised over poses',
           best(lambda: vectorised_fk(joints), 2), None),
          ('NumPy, a loop of 4 x 4 products (5000 poses, times 200)',
           200 * best(lambda: loop_fk(few), 2), None)]
  for what, seconds, _ in rows:
    print(f'| {what} | {seconds:.3g} s | {seconds / ours:.1f} |')


def calibrations():
  arm = alidade.Arm.from_dh(a=A, d=D, alpha=ALPHA,
                            limits=[[-3, 3]] * 6)
  real = arm.with_deviations({'d2': 8e-4, 'theta2': 2e-3, 'r4': -6e-4})
  for count, repeats in ((56, 20), (1000000, 2)):
    data = alidade.simulate(real, count=count, sigma=2e-5)
    options = dict(parameters=['joints', 'base', 'tool'], errors='none',
                   threads=1)
    ratios = []
    for _ in range(repeats + 1):
      begin, busy = time.perf_counter(), time.process_time()
      result = alidade.calibrate(arm, data, **options)
      seconds = time.perf_counter() - begin
      ratios.append((seconds / result.times.total_s,
                     time.process_time() - busy))
    ratio, seconds = sorted(ratios[1:])[len(ratios) // 2 - 1]
    print(f'| `calibrate`, {count} poses, beside the library alone | '
          f'{seconds:.3g} s | {ratio:.3f} |')


def main():
  del sys.argv[1:]
  os.environ.setdefault('OMP_NUM_THREADS', '1')
  print('| what | time | ratio |\n|---|---|---|')
  kinematics()
  calibrations()


main()
