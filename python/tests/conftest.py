"""What tests share: arms, made-up measurements, the program."""

import os
import pathlib

import numpy as np
import pytest

import alidade

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get('ALIDADE_BINARY', ROOT / 'build/release/bin/alidade')
DATA = os.environ.get('ALIDADE_DATA')


def puma(**frames):
  """A six-joint arm by standard Denavit-Hartenberg parameters."""
  limits = np.radians([[-160, 160], [-110, 110], [-135, 135], [-180, 180],
                       [-100, 100], [-180, 180]])
  return alidade.Arm.from_dh(
      convention='standard', name='puma', limits=limits,
      a=[0, 0.4318, -0.0203, 0, 0, 0], d=[0.672, 0, 0.15005, 0.4318, 0, 0.056],
      alpha=np.radians([90, 0, -90, 90, -90, 0]), **frames)


def frame(x=0.0, y=0.0, z=0.0, turn=0.0):
  """Turned about z."""
  matrix = np.eye(4)
  matrix[:2, :2] = [[np.cos(turn), -np.sin(turn)],
                    [np.sin(turn), np.cos(turn)]]
  matrix[:3, 3] = x, y, z
  return matrix


@pytest.fixture(scope='session')
def arm():
  return puma(base=frame(1.2, -0.4, 0.1, 0.3), tool=frame(0.05, 0.02, 0.12))


DEVIATIONS = {'d2': 8e-4, 'theta2': 2e-3, 'theta3': -1e-3, 'r4': -6e-4,
              'alpha4': 1e-3, 'base_x': 2e-3, 'tool_y': -1e-3}


@pytest.fixture(scope='session')
def real(arm):
  return arm.with_deviations(DEVIATIONS)


@pytest.fixture(scope='session')
def data(real):
  return alidade.simulate(real, count=80, sigma=2e-5, seed=3)


OPTIONS = dict(parameters=['joints', 'base', 'tool'], errors='none')


@pytest.fixture(scope='session')
def result(arm, data):
  return alidade.calibrate(arm, data, validation={'fraction': 0.3}, **OPTIONS)
