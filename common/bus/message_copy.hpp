// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace rtd::bus {

/// memcpy of a message that another core reads next or has just written. For a frame, glibc's memcpy writes past the
/// caches, so that the reader fetches it from main memory, and its `rep movsb` is slow between addresses of different
/// alignment (a sample begins 4 bytes behind an aligned address): 1.5 MB to another process take 0.30 instead of 0.42
/// ms.
inline void copy_message(void* to, const void* from, std::size_t bytes) {
  std::size_t done = 0;
#ifdef __SSE2__
  auto* const target = static_cast<char*>(to);
  const auto* const source = static_cast<const char*>(from);
  constexpr std::size_t kLine = 64, kWord = sizeof(__m128i);
  for (; done + kLine <= bytes; done += kLine) {
    __m128i words[kLine / kWord];
    for (std::size_t i = 0; i < kLine / kWord; ++i) {
      words[i] = _mm_loadu_si128(reinterpret_cast<const __m128i*>(source + done + i * kWord));
    }
    for (std::size_t i = 0; i < kLine / kWord; ++i) {
      _mm_storeu_si128(reinterpret_cast<__m128i*>(target + done + i * kWord), words[i]);
    }
  }
#endif
  std::memcpy(static_cast<char*>(to) + done, static_cast<const char*>(from) + done, bytes - done);
}

}  // namespace rtd::bus
