// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/fuzz_loop.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iterator>

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

namespace rtd::fuzz {
namespace {

using io::Bytes;

std::size_t below(std::size_t end, Random& random) {
  return end == 0 ? 0 : random() % end;
}

void overwrite_integer(Bytes& file, Random& random) {
  constexpr std::array<std::uint64_t, 9> kValues{
      0, 1, 0x7f, 0xffff, 0x7fffffff, 0xffffffff, std::uint64_t{1} << 32, std::uint64_t{1} << 63, ~std::uint64_t{0}};
  const std::size_t width = std::size_t{1} << below(4, random);
  if (file.size() < width) return;
  std::byte bytes[8];
  io::store(bytes, kValues[below(kValues.size(), random)] + below(3, random) - 1);
  std::copy_n(bytes, width, file.begin() + static_cast<std::ptrdiff_t>(below(file.size() - width + 1, random)));
}

/// A block of `from` replaces one of `file`, of any sizes.
void splice(Bytes& file, const Bytes& from, Random& random) {
  const std::size_t begin = below(from.size() + 1, random), length = below(from.size() - begin + 1, random);
  const std::size_t at = below(file.size() + 1, random),
                    removed = below(std::min<std::size_t>(file.size() - at, 200) + 1, random);
  const Bytes block(from.begin() + static_cast<std::ptrdiff_t>(begin),
                    from.begin() + static_cast<std::ptrdiff_t>(begin + std::min<std::size_t>(length, 2000)));
  const auto place = file.begin() + static_cast<std::ptrdiff_t>(at);
  file.insert(file.erase(place, place + static_cast<std::ptrdiff_t>(removed)), block.begin(), block.end());
}

void change(Bytes& file, const Bytes& other, Random& random) {
  if (file.empty()) return;
  switch (below(7, random)) {
    case 0:
    case 1:
      file[below(file.size(), random)] ^= std::byte{1} << below(8, random);
      break;
    case 2:
      file[below(file.size(), random)] = static_cast<std::byte>(below(256, random));
      break;
    case 3:
      overwrite_integer(file, random);
      break;
    case 4:
      file.resize(below(file.size() + 1, random));
      break;
    case 5:
      splice(file, Bytes(file), random);
      break;
    default:
      splice(file, other, random);
  }
}

/// What the heap holds, in builds with AddressSanitizer; always 0 in others.
std::size_t held = 0, base = 0, peak = 0;

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

/// Most bytes held at once since the last call, above what was held then.
std::size_t peak_allocation() {
  const std::size_t result = peak - std::min(peak, base);
  base = peak = held;
  return result;
}

/// Why the input is a failure; empty when it is none.
std::string failure_of(const FuzzDriver& driver, const Bytes& input, Random& random) {
  peak_allocation();
  const std::clock_t begin = std::clock();
  if (std::string why = driver.test(input, random); !why.empty()) return why;
  const double cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  if (driver.max_cpu_s > 0 && cpu_s > driver.max_cpu_s) return "it takes too long";
  const std::size_t allocated = peak_allocation();
  const bool bounded = allocated <= driver.max_allocated + driver.max_allocated_per_byte * input.size();
  return bounded ? "" : "it made the reader hold " + std::to_string(allocated) + " bytes";
}

void write(const std::filesystem::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

Bytes bytes_of(std::string_view text) {
  const auto view = io::bytes_of(text);
  return {view.begin(), view.end()};
}

std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Bytes mutate(const Bytes& file, const Bytes& other, Random& random) {
  Bytes changed = file;
  for (std::size_t changes = 1 + below(6, random); changes > 0; --changes) change(changed, other, random);
  return changed;
}

Bytes mutate_one(const std::vector<Bytes>& files, Random& random) {
  return mutate(files[random() % files.size()], files[random() % files.size()], random);
}

Bytes mutate_text(const std::vector<std::string>& texts, const std::vector<std::string>& words, Random& random) {
  const std::string& seed = texts[random() % texts.size()];
  if (random() % 3 == 0) return mutate(bytes_of(seed), bytes_of(texts[random() % texts.size()]), random);
  std::string text = seed;
  for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
    std::string word = words[random() % words.size()];
    if (random() % 40 == 0) {
      const std::string one = word;
      for (std::uint64_t more = random() % 3000; more > 0; --more) word += one;
    }
    std::size_t at = random() % (text.size() + 1);
    if (random() % 2 == 0) at = std::min(text.find('\n', at), text.size());
    text.replace(at, random() % 3 == 0 ? random() % 12 : 0, word);
  }
  return bytes_of(text);
}

int run_fuzz(int argc, char** argv, const FuzzDriver& driver) {
  const std::uint64_t inputs = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 5000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  Random random(seed);
  watch_allocations();
  for (std::uint64_t i = 0; i < inputs; ++i) {
    const Bytes input = driver.make(random);
    const std::string failure = failure_of(driver, input, random);
    if (failure.empty()) continue;
    write(driver.failed_path, input);
    std::fprintf(stderr, "input %llu of seed %llu: %s\n", static_cast<unsigned long long>(i),
                 static_cast<unsigned long long>(seed), failure.c_str());
    return 1;
  }
  std::printf("%llu inputs, all well (%s)\n", static_cast<unsigned long long>(inputs), driver.counted().c_str());
  return 0;
}

void FuzzFile::write(const Bytes& bytes) const {
  fuzz::write(path_, bytes);
}

}  // namespace rtd::fuzz
