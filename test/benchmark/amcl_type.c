// Copyright 2026 diffdrive_kinematics contributors
//
// Licensed under the Apache License, Version 2.0 (the "License");
// you may not use this file except in compliance with the License.
// You may obtain a copy of the License at
//
//     http://www.apache.org/licenses/LICENSE-2.0
//
// Unless required by applicable law or agreed to in writing, software
// distributed under the License is distributed on an "AS IS" BASIS,
// WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
// See the License for the specific language governing permissions and
// limitations under the License.

// Odometry sampling of the type that AMCL uses (Thrun, Burgard, Fox, "Probabilistic Robotics",
// table 5.6): a turn, a straight line and a turn, each with a Gaussian of its own for every pose.
// Gaussians by the polar method with rejection on drand48; differences of angles by
// atan2(sin, cos), twice, for the way forward and the way back.

#define _GNU_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static double normalized(double angle)
{
  return atan2(sin(angle), cos(angle));
}

static double angle_difference(double a, double b)
{
  a = normalized(a);
  b = normalized(b);
  double short_way = a - b;
  double long_way = 2.0 * M_PI - fabs(short_way);
  if (short_way > 0.0) {
    long_way = -long_way;
  }
  return fabs(short_way) < fabs(long_way) ? short_way : long_way;
}

static double gaussian(double sigma)
{
  double a, b, square;
  do {
    do {
      a = drand48();
    } while (a == 0.0);
    do {
      b = drand48();
    } while (b == 0.0);
    a = 2.0 * a - 1.0;
    b = 2.0 * b - 1.0;
    square = a * a + b * b;
  } while (square > 1.0 || square == 0.0);
  return sigma * b * sqrt(-2.0 * log(square) / square);
}

void seed_amcl_type(unsigned long seed)
{
  srand48((long)seed);
}

// Move n poses, given as rows (x, y, theta) as in a set of particles, by (dx, dy, turn) [m, rad].
void amcl_type(
  double * poses, size_t n, double heading, double dx, double dy, double turn,
  const double * alpha)
{
  double distance = sqrt(dx * dx + dy * dy);
  double rot1 = distance < 0.01 ? 0.0 : angle_difference(atan2(dy, dx), heading);
  double rot2 = angle_difference(turn, rot1);
  double rot1_noise = fmin(
    fabs(angle_difference(rot1, 0.0)), fabs(angle_difference(rot1, M_PI)));
  double rot2_noise = fmin(
    fabs(angle_difference(rot2, 0.0)), fabs(angle_difference(rot2, M_PI)));
  for (size_t i = 0; i < n; ++i) {
    double * pose = poses + 3 * i;
    double rot1_hat = angle_difference(
      rot1, gaussian(alpha[0] * rot1_noise * rot1_noise + alpha[1] * distance * distance));
    double distance_hat = distance - gaussian(
      alpha[2] * distance * distance + alpha[3] * rot1_noise * rot1_noise +
      alpha[3] * rot2_noise * rot2_noise);
    double rot2_hat = angle_difference(
      rot2, gaussian(alpha[0] * rot2_noise * rot2_noise + alpha[1] * distance * distance));
    pose[0] += distance_hat * cos(pose[2] + rot1_hat);
    pose[1] += distance_hat * sin(pose[2] + rot1_hat);
    pose[2] += rot1_hat + rot2_hat;
  }
}
