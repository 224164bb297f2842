// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/mcap/allocation_watch.hpp"

#include <algorithm>

#if defined(__SANITIZE_ADDRESS__)
// Of the runtime of AddressSanitizer; GCC has no header for them.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));
extern "C" std::size_t __sanitizer_get_allocated_size(const volatile void* memory);

extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() {
  return "halt_on_error=1:print_stacktrace=1";
}
#endif

namespace rtd::testing {
namespace {

std::size_t held = 0, base = 0, peak = 0;

}  // namespace

#if defined(__SANITIZE_ADDRESS__)
void watch_allocations() {
  __sanitizer_install_malloc_and_free_hooks(
      [](const volatile void*, std::size_t size) { peak = std::max(peak, held += size); },
      [](const volatile void* memory) {
        if (memory != nullptr) held -= std::min(held, __sanitizer_get_allocated_size(memory));
      });
}
#else
void watch_allocations() {}
#endif

std::size_t peak_allocation() {
  const std::size_t result = peak - std::min(peak, base);
  base = peak = held;
  return result;
}

}  // namespace rtd::testing
