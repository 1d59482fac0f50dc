// Three-vectors of the contact plane: sums, products, projection.
// No equation of a paper; assumes nothing but finite components.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_KERNELS_VEC3_H
#define PYJKR_KERNELS_VEC3_H

#include <cmath>

namespace pyjkr {

struct Vec3 {
  double x, y, z;
};

inline Vec3 load(const double* p) { return {p[0], p[1], p[2]}; }
inline void store(const Vec3& a, double* p) { p[0] = a.x; p[1] = a.y; p[2] = a.z; }
inline void accumulate(const Vec3& a, double* p) { p[0] += a.x; p[1] += a.y; p[2] += a.z; }

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Part of a in the plane normal to the unit vector n.
inline Vec3 tangential_part(const Vec3& a, const Vec3& n) { return a - dot(a, n) * n; }

}  // namespace pyjkr

#endif
