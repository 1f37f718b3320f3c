# Copyright 2026 diffdrive_kinematics contributors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""
How wheels slip, and what that does to the pose.

Bias and slip laws with their distributions, what lasts a run, the covariance of the pose along an
arc, sample paths, and the set that bounded slip can reach.  An order in which to read the files:

* laws of slip: ``distributions``, ``noise`` (the wheels), ``body_slip``, ``session_errors``;
* the covariance of odometry, exactly: ``pose_covariance``, ``heading_moments``, ``pose_moments``,
  ``arc_moments`` by ``integrated_moments`` and ``turning_moments``; ``session_belief``;
  ``twist_covariance``; ``planar``, from what others say;
* to first order: ``arc_means``, ``first_order``, ``path_arcs``, ``matrices``;
* samples: ``step_noise``, ``projection``; chunk by chunk ``columns``, ``arcs_in_place`` with
  ``half_angles`` and ``normals``;
* sets: ``stage``, ``reachable``, ``reach_mesh``, ``outline``, ``polygons``;
* ``projected``: samples and boundary for a message.
"""

from diffdrive_kinematics.core.noise.arc_moments import (
    arc_moments, propagated_moments, slip_on_arc)
from diffdrive_kinematics.core.noise.body_slip import body_variances, BodySlip, NO_BODY_SLIP
from diffdrive_kinematics.core.noise.distributions import (
    check_distribution, DISTRIBUTIONS, draw_unit, sample_heading, unit_bound)
from diffdrive_kinematics.core.noise.first_order import (
    moved_covariance, propagated_covariance, slip_covariance)
from diffdrive_kinematics.core.noise.heading_moments import heading_variance, HeadingMoments
from diffdrive_kinematics.core.noise.matrices import pose_jacobians, rotations
from diffdrive_kinematics.core.noise.noise import (
    check_slip_model, effective_ratio, sample_travel, SLIP_MODELS, travel_variance, WheelSlip)
from diffdrive_kinematics.core.noise.outline import outer_boundary
from diffdrive_kinematics.core.noise.path_arcs import (
    arcs_along, ArcsAlong, body_covariance_along, covariance_along)
from diffdrive_kinematics.core.noise.planar import (
    planar_covariance, planar_pose, yaw_from_quaternion)
from diffdrive_kinematics.core.noise.polygons import area, perimeter, simplified
from diffdrive_kinematics.core.noise.pose_covariance import NO_COVARIANCE, PoseCovariance
from diffdrive_kinematics.core.noise.pose_moments import (
    CERTAIN, followed, gaussian_moments, heading_moments, PoseMoments, second_moment_after)
from diffdrive_kinematics.core.noise.projected import Projected, projected
from diffdrive_kinematics.core.noise.projection import propagate, sample_paths
from diffdrive_kinematics.core.noise.reachable import reachable_set, reachable_set_from_slip
from diffdrive_kinematics.core.noise.session_belief import SessionBelief
from diffdrive_kinematics.core.noise.session_errors import (
    check_session_fraction, draw_session, NO_SESSION, session_generator, SessionError,
    SessionSpread, travel_in_session)
from diffdrive_kinematics.core.noise.stage import Stage, stage_from_slip
from diffdrive_kinematics.core.noise.step_noise import step_noise, StepNoise, travel_of_command
from diffdrive_kinematics.core.noise.twist_covariance import twist_covariance, TwistCovariance

__all__ = [
    'ArcsAlong', 'BodySlip', 'CERTAIN', 'DISTRIBUTIONS', 'HeadingMoments', 'NO_BODY_SLIP',
    'NO_COVARIANCE', 'NO_SESSION', 'PoseCovariance', 'PoseMoments', 'Projected', 'SLIP_MODELS',
    'SessionBelief', 'SessionError', 'SessionSpread', 'Stage', 'StepNoise', 'TwistCovariance',
    'WheelSlip', 'arc_moments', 'arcs_along', 'area', 'body_covariance_along', 'body_variances',
    'check_distribution', 'check_session_fraction', 'check_slip_model', 'covariance_along',
    'draw_session', 'draw_unit', 'effective_ratio', 'followed', 'gaussian_moments',
    'heading_moments', 'heading_variance', 'moved_covariance', 'outer_boundary', 'perimeter',
    'planar_covariance', 'planar_pose', 'pose_jacobians', 'projected', 'propagate',
    'propagated_covariance', 'propagated_moments', 'reachable_set', 'reachable_set_from_slip',
    'rotations', 'sample_heading', 'sample_paths', 'sample_travel', 'second_moment_after',
    'session_generator', 'simplified', 'slip_covariance', 'slip_on_arc', 'stage_from_slip',
    'step_noise', 'travel_in_session', 'travel_of_command', 'travel_variance', 'twist_covariance',
    'unit_bound', 'yaw_from_quaternion']
