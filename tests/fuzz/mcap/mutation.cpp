// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/mcap/mutation.hpp"

#include <algorithm>
#include <array>

namespace rtd::mcap {
namespace {

std::size_t below(std::size_t end, std::mt19937_64& random) {
  return end == 0 ? 0 : random() % end;
}

void overwrite_integer(Bytes& file, std::mt19937_64& random) {
  constexpr std::array<std::uint64_t, 9> kValues{
      0, 1, 0x7f, 0xffff, 0x7fffffff, 0xffffffff, std::uint64_t{1} << 32, std::uint64_t{1} << 63, ~std::uint64_t{0}};
  const std::size_t width = std::size_t{1} << below(4, random);
  if (file.size() < width) return;
  std::byte bytes[8];
  io::store(bytes, kValues[below(kValues.size(), random)] + below(3, random) - 1);
  std::copy_n(bytes, width, file.begin() + static_cast<std::ptrdiff_t>(below(file.size() - width + 1, random)));
}

/// A block of `from` replaces one of `file`, of any sizes.
void splice(Bytes& file, const Bytes& from, std::mt19937_64& random) {
  const std::size_t begin = below(from.size() + 1, random), length = below(from.size() - begin + 1, random);
  const std::size_t at = below(file.size() + 1, random),
                    removed = below(std::min<std::size_t>(file.size() - at, 200) + 1, random);
  const Bytes block(from.begin() + static_cast<std::ptrdiff_t>(begin),
                    from.begin() + static_cast<std::ptrdiff_t>(begin + std::min<std::size_t>(length, 2000)));
  const auto place = file.begin() + static_cast<std::ptrdiff_t>(at);
  file.insert(file.erase(place, place + static_cast<std::ptrdiff_t>(removed)), block.begin(), block.end());
}

void change(Bytes& file, const Bytes& other, std::mt19937_64& random) {
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

}  // namespace

Bytes mutate(const Bytes& file, const Bytes& other, std::mt19937_64& random) {
  Bytes changed = file;
  for (std::size_t changes = 1 + below(6, random); changes > 0; --changes) change(changed, other, random);
  return changed;
}

}  // namespace rtd::mcap
