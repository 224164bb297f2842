// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed map files: refused, or what is read is a sound map that is written as it was read.
#include "common/io/bytes.hpp"
#include "services/slam/core/store/map_store.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/support/sample_map.hpp"

namespace rtd::slam {
namespace {

using io::Bytes;
using io::ByteView;

Bytes bytes_of(const Map& map) {
  io::MemorySink sink;
  write_map(take_snapshot(map), sink);
  return sink.bytes();
}

std::vector<Bytes> seeds() {
  std::vector<Bytes> files;
  for (const std::uint32_t keyframes : {1, 3, 6, 12})
    files.push_back(bytes_of(test_support::sample_map(
        {.keyframes = keyframes, .features = 12, .seen_per_keyframe = 5, .new_per_keyframe = 3, .seed = keyframes})));
  return files;
}

/// Lets every checksum fit again, so that what is behind the checksums is reached.
void reseal(Bytes& file) {
  constexpr std::size_t kPreamble = 12, kHead = 8, kCrc = 4;
  if (file.size() < kPreamble + kCrc) return;
  io::store(file.data() + kPreamble, io::crc32(ByteView(file).first(kPreamble)));
  for (std::size_t at = kPreamble + kCrc; at + kHead + kCrc <= file.size();) {
    const std::size_t size = io::load<std::uint32_t>(file.data() + at + 4);
    if (size > file.size() - at - kHead - kCrc) return;
    io::store(file.data() + at + kHead + size, io::crc32(ByteView(file).subspan(at, kHead + size)));
    at += kHead + size + kCrc;
  }
}

/// Changes values, not sizes: most such files are still made of blocks.
void change_values(Bytes& file, fuzz::Random& random) {
  constexpr std::array<std::uint64_t, 8> kValues{
      0, 1, 0x7F, 0xFFFF, 0xFFFFFFFF, 0x7FF8000000000000, 0x7FF0000000000000, ~std::uint64_t{0}};
  constexpr std::size_t kBlocks = 16;
  for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
    const std::size_t width = std::size_t{1} << (random() % 4);
    const std::size_t at = kBlocks + random() % (file.size() - kBlocks - width);
    std::byte bytes[8];
    io::store(bytes, random() % 2 == 0 ? kValues[random() % kValues.size()] : random() % 32);
    std::copy_n(bytes, width, file.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

/// Says that a block has another size: a little off, none, or more than any computer has. The rest is as it was.
void change_size(Bytes& file, fuzz::Random& random) {
  constexpr std::size_t kBlocks = 16, kHead = 8, kCrc = 4;
  std::vector<std::size_t> sizes;
  for (std::size_t at = kBlocks; at + kHead + kCrc <= file.size();) {
    sizes.push_back(at + 4);
    at += kHead + kCrc + io::load<std::uint32_t>(file.data() + at + 4);
  }
  if (sizes.empty()) return;
  std::byte* const place = file.data() + sizes[random() % sizes.size()];
  const auto size = io::load<std::uint32_t>(place);
  const std::array<std::uint32_t, 8> hostile{0,          size - 1,   size + 1,   size / 2,
                                             0x7FFFFFFF, 0xFFFFFFFF, 0xFFFFFFF4, static_cast<std::uint32_t>(random())};
  io::store(place, hostile[random() % hostile.size()]);
}

Bytes make_input(const std::vector<Bytes>& files, fuzz::Random& random) {
  const Bytes& file = files[random() % files.size()];
  const std::uint64_t way = random() % 5;
  if (way == 0) return fuzz::mutate(file, files[random() % files.size()], random);
  Bytes input = way == 1 ? fuzz::mutate(file, files[random() % files.size()], random) : file;
  if (way == 2 || way == 3) change_values(input, random);
  if (way == 4) change_size(input, random);
  reseal(input);
  return input;
}

/// The byte of the head that says so; such a file is written again in the present form.
bool is_of_an_earlier_version(const Bytes& file) {
  constexpr std::size_t kOrigin = 52;  // preamble, head of the block, seven counts
  return file.size() > kOrigin && file[kOrigin] == std::byte{1};
}

/// Why the input is a failure; empty when it is none. Counts the inputs that are maps.
std::string try_input(const Bytes& file, std::uint64_t& maps) {
  try {
    const io::MemorySource source(file);
    const std::size_t skimmed = read_map(source, {StoredFeatures::kSkip, {}}).keyframes.size();
    const Map map(read_map(source));
    if (std::string broken = map.check_invariants(); !broken.empty()) return "it became an unsound map: " + broken;
    if (map.keyframes().size() != skimmed) return "it has other keyframes without features";
    if (!is_of_an_earlier_version(file) && bytes_of(map) != file) return "written again it is another file";
    ++maps;
  } catch (const MapFileError&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd::slam

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = slam::seeds();
  std::uint64_t maps = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_map_failed.rtdmap",
       .make = [&](fuzz::Random& random) { return slam::make_input(files, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return slam::try_input(input, maps); },
       .counted = [&] { return std::to_string(maps) + " of them maps"; },
       .max_allocated = 24 << 20,  // what the reader allows itself, a block twice, and the map that is made of it
       .max_allocated_per_byte = 96});
}
