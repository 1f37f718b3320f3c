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

// The step of diffdrive_kinematics.core.noise.propagate in scalar C: the same arithmetic and
// memory layout, sin and cos of libm, the generator SFC64, normals by the ziggurat of 256 layers.

#include <math.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
  uint64_t a, b, c, counter;
} Sfc64;

static const double R = 3.6541528853610088;  // where the tail of the ziggurat begins
static const double AREA = 0.00492867323399;  // of each layer
static double width[257], height[257];
static Sfc64 state;

static inline uint64_t next64(Sfc64 * s)
{
  uint64_t result = s->a + s->b + s->counter++;
  s->a = s->b ^ (s->b >> 11);
  s->b = s->c + (s->c << 3);
  s->c = ((s->c << 24) | (s->c >> 40)) + result;
  return result;
}

static inline double uniform(Sfc64 * s)
{
  return (double)(next64(s) >> 11) * 0x1p-53;
}

void seed_same_maths(uint64_t seed)
{
  state = (Sfc64){seed, seed, seed, 1};
  for (int i = 0; i < 12; ++i) {
    next64(&state);
  }
  // Layer i reaches from height[i] to height[i + 1]; layer 0 stands for base and tail.
  width[0] = AREA / exp(-0.5 * R * R);
  width[1] = R;
  height[0] = 0.0;
  height[1] = exp(-0.5 * R * R);
  for (int i = 1; i < 256; ++i) {
    height[i + 1] = height[i] + AREA / width[i];
    width[i + 1] = height[i + 1] < 1.0 ? sqrt(-2.0 * log(height[i + 1])) : 0.0;
  }
}

static double tail(Sfc64 * s, double sign)
{
  for (;;) {
    double x = -log1p(-uniform(s)) / R;
    double y = -log1p(-uniform(s));
    if (y + y > x * x) {
      return sign * (R + x);
    }
  }
}

static inline double normal(Sfc64 * s)
{
  for (;;) {
    uint64_t bits = next64(s);
    int layer = (int)(bits & 255);
    double sign = bits & 256 ? -1.0 : 1.0;
    double x = (double)(bits >> 12) * 0x1p-52 * width[layer];
    if (x < width[layer + 1]) {
      return sign * x;
    }
    if (layer == 0) {
      return tail(s, sign);
    }
    double y = height[layer] + uniform(s) * (height[layer + 1] - height[layer]);
    if (y < exp(-0.5 * x * x)) {
      return sign * x;
    }
  }
}

// Write n normals, for the test of the sampler.
void normals(double * out, size_t n)
{
  for (size_t i = 0; i < n; ++i) {
    out[i] = normal(&state);
  }
}

// Move n poses by wheel travel [m] with standard deviations [m], lateral one included.
void same_maths(
  const double * x, const double * y, const double * theta,
  double * x_out, double * y_out, double * theta_out, size_t n,
  double d_left, double d_right, double separation,
  double sigma_left, double sigma_right, double sigma_lateral)
{
  Sfc64 s = state;
  for (size_t i = 0; i < n; ++i) {
    double left = d_left + sigma_left * normal(&s);
    double right = d_right + sigma_right * normal(&s);
    double lateral = sigma_lateral * normal(&s);
    double half = (right - left) / (2.0 * separation);
    double sinc = half == 0.0 ? 1.0 : sin(half) / half;
    double chord = 0.5 * (left + right) * sinc;
    double direction = theta[i] + half;
    double cosine = cos(direction), sine = sin(direction);
    x_out[i] = x[i] + chord * cosine - lateral * sine;
    y_out[i] = y[i] + chord * sine + lateral * cosine;
    theta_out[i] = direction + half;
  }
  state = s;
}
