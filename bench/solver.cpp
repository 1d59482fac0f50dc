// The contact solver alone: u^4 - u = D and F = 8/3 u^6 - 4 u^3, by several methods, side by side.
// Throughput (independent contacts), latency (each waits for the one before, as in a pair loop), largest error against
// long double. Only the first two live in the plug-in. Prints one line of CSV a method.
// SPDX-License-Identifier: GPL-2.0-or-later

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <time.h>

#include "../liggghts_src/kernels/jkr_normal.h"

namespace {

using pyjkr::kRuptureOverlap;
using pyjkr::kRuptureRoot;

double force_of(double u) {
  const double cube = u * u * u;
  return cube * (8.0 / 3.0 * cube - 4.0);
}

// ---- the methods: D -> u ----

double ours(double d, std::size_t) { return pyjkr::contact_radius_root(d); }

// From above the root Newton falls monotonically, so it ends where it stops falling.
double newton(double d, std::size_t) {
  double u = 1.0 + std::sqrt(std::sqrt(d > 0.0 ? d : 0.0));
  for (int k = 0; k < 100; ++k) {
    const double square = u * u;
    const double next = u - (square * square - u - d) / (4.0 * square * u - 1.0);
    if (!(next < u)) break;
    u = next;
  }
  return u;
}

// Ferrari, every branch without cancellation:
// y > 0 is the real root of y^3 + 4 D y - 1 = 0; then u = (sqrt(y) + sqrt(2/sqrt(y) - y))/2.
double ferrari(double d, std::size_t) {
  const double p = 4.0 / 3.0 * d;
  const double discriminant = 0.25 + p * p * p;
  double y;
  if (discriminant < 0.0) {
    y = 2.0 * std::sqrt(-p) * std::cos(std::acos(std::min(1.0, 0.5 / (-p * std::sqrt(-p)))) / 3.0);
  } else {
    const double s = std::cbrt(0.5 + std::sqrt(discriminant));
    // s - p/s cancels for large D: (s^3 - t^3)/(s^2 + s t + t^2) with t = p/s and s^3 - t^3 = 1
    const double t = p / s;
    y = 1.0 / (s * s + s * t + t * t);
  }
  const double root = std::sqrt(y);
  return 0.5 * (root + std::sqrt(std::max(0.0, 2.0 / root - y)));
}

double halley(double u, double d) {
  const double square = u * u;
  const double residual = square * square - u - d;
  const double slope = 4.0 * square * u - 1.0;
  return u - 2.0 * residual * slope / (2.0 * slope * slope - 12.0 * residual * square);
}

// The same start and step, rearranged for latency: the root and the division beside each other, the polynomial in pairs.
double rearranged(double d, std::size_t) {
  const double square = std::max(0.0, d - kRuptureOverlap);
  const double t = std::sqrt(square);
  const double v = std::sqrt(t + 1.2) * (1.0 / (t + 1.2));
  const double v2 = v * v, v4 = v2 * v2;
  const double low = (0.9999991103220877 - 0.6298469944123006 * v) + v2 * (0.5976449543859754 - 0.48756964688412713 * v);
  const double high = (0.35296495840789877 - 0.17388251108722425 * v) + v2 * 0.03954899984964313;
  const double w = t * v * (low + v4 * high);
  const double w2 = w * w, u = w + kRuptureRoot;
  constexpr double c1 = 4.0 * kRuptureRoot, c2 = 6.0 * kRuptureRoot * kRuptureRoot;
  const double residual = w2 * (w2 + (c1 * w + c2)) - square;
  const double slope = w * (4.0 * w2 + (3.0 * c1 * w + 2.0 * c2));
  return u - residual * slope / (slope * slope - residual * (6.0 * u * u));
}

// Table uniform in t = sqrt(D - D_c), where u is smooth, straight lines between its points, one Halley step.
constexpr double kLongest = 12.0;
constexpr int kPoints = 10000;
std::vector<double> table_of_roots;

double table(double d, std::size_t) {
  const double t = std::sqrt(std::max(0.0, d - kRuptureOverlap)) * (kPoints / kLongest);
  const int k = std::min(static_cast<int>(t), kPoints - 1);
  const double low = table_of_roots[k];
  return halley(low + (t - k) * (table_of_roots[k + 1] - low), d);
}

// The start of jkr_normal.h cut to degree 5, refitted: relative error below 4e-7 over t in [0, 12].
double degree_five(double d, std::size_t) {
  const double t = std::sqrt(std::max(0.0, d - kRuptureOverlap));
  const double v = 1.0 / std::sqrt(t + 1.2);
  const double p =
      0.9994577799219166 +
      v * (-0.6226660548111506 +
           v * (0.5590404386654106 + v * (-0.3803561381145885 + v * (0.19106527680372343 + v * -0.047861957454925094))));
  return halley(kRuptureRoot + t * v * p, d);
}

// The root of one step ago as the start, as a value kept in the contact's history would give it.
std::vector<double> last_roots;
constexpr double kDrift = 0.02;  // of D between two steps, of the size of a step at 60 steps a collision

double warm_one(double d, std::size_t k) { return halley(last_roots[k], d); }
double warm_two(double d, std::size_t k) { return halley(halley(last_roots[k], d), d); }

void remember_last_roots(const std::vector<double>& overlaps) {
  last_roots.resize(overlaps.size());
  for (std::size_t k = 0; k < overlaps.size(); ++k) last_roots[k] = newton(overlaps[k] + (k % 2 ? kDrift : -kDrift), k);
}

// The plug-in's way: a batch of contacts side by side, compiled for AVX2 where the machine has it.
constexpr std::size_t kBatch = 64;

inline void roots_of_batch(const double* overlaps, double* roots) {
  for (std::size_t k = 0; k < kBatch; ++k) roots[k] = pyjkr::contact_radius_root(overlaps[k]);
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"), flatten)) void roots_with_avx2(const double* overlaps, double* roots) {
  roots_of_batch(overlaps, roots);
}
#endif

void batch_of_roots(const double* overlaps, double* roots) {
#if defined(__x86_64__)
  static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (wide) return roots_with_avx2(overlaps, roots);
#endif
  roots_of_batch(overlaps, roots);
}

// What an adhesionless contact pays: a = sqrt(R delta).
double hertz(double d, std::size_t) { return std::sqrt(d); }

// ---- measuring ----

double seconds() {
  // of this process: what else the machine does is not counted
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

template <double (*Root)(double, std::size_t)>
struct Timed {
  static double throughput(const std::vector<double>& overlaps, int rounds, std::vector<double>& forces) {
    const double begin = seconds();
    for (int r = 0; r < rounds; ++r) {
      for (std::size_t k = 0; k < overlaps.size(); ++k) forces[k] = force_of(Root(overlaps[k], k));
      asm volatile("" : : "r"(forces.data()) : "memory");
    }
    return 1e9 * (seconds() - begin) / (static_cast<double>(rounds) * overlaps.size());
  }
  // The next overlap waits for the last force through a product with a zero that the compiler cannot see.
  static double latency(const std::vector<double>& overlaps, int rounds, double zero) {
    double carried = 0.0;
    const double begin = seconds();
    for (int r = 0; r < rounds; ++r)
      for (std::size_t k = 0; k < overlaps.size(); ++k) carried = force_of(Root(overlaps[k] + zero * carried, k));
    const double end = seconds();
    asm volatile("" : : "x"(carried));
    return 1e9 * (end - begin) / (static_cast<double>(rounds) * overlaps.size());
  }
};

// The same for batches; latency: the next batch waits for the last force of this one.
double batch_throughput(const std::vector<double>& overlaps, int rounds, std::vector<double>& forces) {
  double roots[kBatch];
  const double begin = seconds();
  for (int r = 0; r < rounds; ++r) {
    for (std::size_t first = 0; first < overlaps.size(); first += kBatch) {
      batch_of_roots(&overlaps[first], roots);
      for (std::size_t k = 0; k < kBatch; ++k) forces[first + k] = force_of(roots[k]);
    }
    asm volatile("" : : "r"(forces.data()) : "memory");
  }
  return 1e9 * (seconds() - begin) / (static_cast<double>(rounds) * overlaps.size());
}

double batch_latency(const std::vector<double>& overlaps, int rounds, double zero) {
  double shifted[kBatch], roots[kBatch], carried = 0.0;
  const double begin = seconds();
  for (int r = 0; r < rounds; ++r)
    for (std::size_t first = 0; first < overlaps.size(); first += kBatch) {
      for (std::size_t k = 0; k < kBatch; ++k) shifted[k] = overlaps[first + k] + zero * carried;
      batch_of_roots(shifted, roots);
      double force = 0.0;
      for (std::size_t k = 0; k < kBatch; ++k) force = force_of(roots[k]);
      carried = force;
    }
  const double end = seconds();
  asm volatile("" : : "x"(carried));
  return 1e9 * (end - begin) / (static_cast<double>(rounds) * overlaps.size());
}

struct Error {
  double root = 0.0;    // relative
  double force = 0.0;   // of max(|F|, F_C), F_C = 3/2 here
};

template <double (*Root)(double, std::size_t)>
Error largest_error(const std::vector<double>& overlaps, bool hertzian) {
  Error error;
  for (std::size_t index = 0; index < overlaps.size(); ++index) {
    const double d = overlaps[index];
    long double u = hertzian ? sqrtl(static_cast<long double>(d)) : 0.0L;
    if (!hertzian) {
      u = std::max<long double>(newton(d, index), 0.63L) + 1e-3L;  // above the root: Newton falls to it
      for (int k = 0; k < 60; ++k) u -= (u * u * u * u - u - d) / (4.0L * u * u * u - 1.0L);
    }
    const double found = Root(d, index);
    const long double force = u * u * u * (8.0L / 3.0L * u * u * u - 4.0L);
    error.root = std::max(error.root, static_cast<double>(fabsl(found / u - 1.0L)));
    error.force = std::max(error.force, static_cast<double>(fabsl(force_of(found) - force) / std::max(fabsl(force), 1.5L)));
  }
  return error;
}

double batch_root(double d, std::size_t) {
  double overlaps[kBatch], roots[kBatch];
  std::fill_n(overlaps, kBatch, d);
  batch_of_roots(overlaps, roots);
  return roots[kBatch / 2];
}

// One row of the table and the samples it is made of.
struct Method {
  const char* name;
  double (*throughput)(const std::vector<double>&, int, std::vector<double>&);
  double (*latency)(const std::vector<double>&, int, double);
  Error (*error)(const std::vector<double>&, bool);
  bool hertzian;
  std::vector<double> throughputs, latencies;
};

template <double (*Root)(double, std::size_t)>
Method method(const char* name, bool hertzian = false) {
  return {name, &Timed<Root>::throughput, &Timed<Root>::latency, &largest_error<Root>, hertzian, {}, {}};
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

// solver ROUNDS REPEATS
int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 200, repeats = argc > 2 ? std::atoi(argv[2]) : 7;
  const double zero = argc > 3 ? std::atof(argv[3]) : 0.0;
  table_of_roots.resize(kPoints + 1);
  for (int k = 0; k <= kPoints; ++k) {
    const double t = kLongest * k / kPoints;
    table_of_roots[k] = k == 0 ? kRuptureRoot : newton(t * t + kRuptureOverlap, k);
  }
  // overlaps from 0 to about ten times that without load (D = 0.57), in an order that no predictor learns
  std::vector<double> overlaps(4096), errors(200001);
  unsigned long long state = 88172645463325252ULL;
  for (double& d : overlaps) {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    d = 1e-3 + 6.0 * static_cast<double>(state >> 11) / 9007199254740992.0;
  }
  for (std::size_t k = 0; k < errors.size(); ++k) errors[k] = 1e-6 + 100.0 * k / errors.size();
  std::printf("method,throughput_ns,latency_ns,root_error,force_error\n");
  std::vector<Method> methods = {
      {"ours: 64 contacts at a time", &batch_throughput, &batch_latency, &largest_error<batch_root>, false, {}, {}},
      method<ours>("ours: one contact (walls)"),
      method<rearranged>("degree-6 start + one Halley step arranged for latency"),
      method<degree_five>("degree-5 start + one Halley step"),
      method<table>("table in sqrt(D - D_c) + one Halley step"),
      method<warm_one>("root of the last step + one Halley step"),
      method<warm_two>("root of the last step + two Halley steps"),
      method<ferrari>("Ferrari written stably"),
      method<newton>("Newton to convergence"),
      method<hertz>("Hertz: one square root", true),
  };
  std::vector<double> forces(overlaps.size());
  remember_last_roots(overlaps);
  for (int r = 0; r < repeats; ++r)
    for (Method& one : methods) {
      one.throughputs.push_back(one.throughput(overlaps, rounds, forces));
      one.latencies.push_back(one.latency(overlaps, rounds, zero));
    }
  remember_last_roots(errors);
  for (Method& one : methods) {
    const Error error = one.error(errors, one.hertzian);
    std::printf("%s,%.3f,%.3f,%.3g,%.3g\n", one.name, median(one.throughputs), median(one.latencies), error.root, error.force);
  }
  return 0;
}
