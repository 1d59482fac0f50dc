// Which instructions the pair loop may use: one copy for every x86-64 machine, one with AVX2 and fused multiply-add.
// Both are compiled from the same source and agree to round-off; the machine decides once, when the pair style is made.
// SPDX-License-Identifier: GPL-2.0-or-later

#ifndef PYJKR_ADAPTERS_INSTRUCTIONS_H
#define PYJKR_ADAPTERS_INSTRUCTIONS_H

#include <cstdlib>
#include <cstring>

// What one contact in thousands needs is kept out of the loop.
#define PYJKR_RARE __attribute__((noinline))

// flatten: what the loop calls is compiled anew inside it, for the same instructions.
#if defined(__x86_64__) && defined(__GNUC__)
#define PYJKR_WITH_AVX2 __attribute__((target("avx2,fma"), flatten))
#else
#define PYJKR_WITH_AVX2
#endif

namespace pyjkr {

enum class Instructions { portable, avx2 };

// PYJKR_INSTRUCTIONS=portable asks for the copy that every machine has: to compare, or to repeat a run of an old machine.
inline Instructions instructions_of_this_machine() {
  const char* const wish = std::getenv("PYJKR_INSTRUCTIONS");
  if (wish && std::strcmp(wish, "portable") == 0) return Instructions::portable;
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return Instructions::avx2;
#endif
  return Instructions::portable;
}

}  // namespace pyjkr

#endif
