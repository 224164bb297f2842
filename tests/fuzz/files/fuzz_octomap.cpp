// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed OctoMap files: no exception but OctomapError; what is read is written and read again as the same map.
#include <sstream>

#include "common/occupancy/octomap_file.hpp"
#include "tests/fuzz/fuzz_loop.hpp"

namespace rtd::occupancy {
namespace {

constexpr std::size_t kFewCells = 20'000;  // liboctomap takes long for more

std::string write(const Volume& volume) {
  std::ostringstream out;
  write_octomap(out, volume);
  return out.str();
}

std::vector<io::Bytes> seeds() {
  Volume room, scattered;
  for (int i = 0; i < 16 * 16 * 16; ++i) room.cells.set({i % 16, i / 16 % 16, i / 256}, Space::kFree);
  for (int i = 0; i < 16 * 16; ++i) room.cells.set({16, i % 16, i / 16}, Space::kOccupied);
  for (int i = 0; i < 40; ++i) scattered.cells.set({i * 37 - 700, i * i - 300, i % 5}, Space::kOccupied);
  return {fuzz::bytes_of(write(room)), fuzz::bytes_of(write(scattered)), fuzz::bytes_of(write({}))};
}

std::string header(const std::string& size, const std::string& cell_m) {
  return "# Octomap OcTree binary file\nid OcTree\nsize " + size + "\nres " + cell_m + "\ndata\n";
}

/// A few random nodes behind a good header: large cells, deep branches.
io::Bytes random_nodes(fuzz::Random& random) {
  const char* sizes[] = {"9", "0", "-1", "1e300", "nan", "18446744073709551616"};
  const char* cells[] = {"0.05", "1e-3", "100", "0", "nan", "1e300", "-1"};
  std::string file = header(sizes[random() % 6], cells[random() % 4 == 0 ? random() % 7 : 0]);
  for (std::uint64_t bytes = random() % 200; bytes > 0; --bytes)
    file += static_cast<char>(random() % 3 == 0 ? 0xFF : random() % 2 == 0 ? 0 : random());
  return fuzz::bytes_of(file);
}

std::size_t count(const Volume& volume) {
  std::size_t cells = 0;
  volume.cells.for_each([&](const Eigen::Vector3i&, Space) { ++cells; });
  return cells;
}

std::string compare_written(const Volume& volume) {
  std::istringstream in(write(volume));
  const Volume again = read_octomap(in);
  bool same = count(again) == count(volume);
  volume.cells.for_each(
      [&](const Eigen::Vector3i& cell, Space space) { same = same && again.cells.value(cell) == space; });
  return same ? "" : "written and read again it is another map";
}

std::string try_input(const io::Bytes& input, std::uint64_t& maps) {
  try {
    std::istringstream in(fuzz::text_of(input));
    const Volume volume = read_octomap(in);
    ++maps;
    if (volume.cells.blocks() < kFewCells / 64 && count(volume) < kFewCells)
      if (std::string why = compare_written(volume); !why.empty()) return why;
  } catch (const OctomapError&) {
  }
  return "";
}

}  // namespace
}  // namespace rtd::occupancy

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = occupancy::seeds();
  std::uint64_t maps = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_octomap_failed.bt",
       .make =
           [&](fuzz::Random& random) {
             return random() % 4 == 0 ? occupancy::random_nodes(random) : fuzz::mutate_one(files, random);
           },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return occupancy::try_input(input, maps); },
       .counted = [&] { return std::to_string(maps) + " of them maps"; },
       .max_allocated = std::size_t{300} << 20,  // 200 million cells, and 48 nodes a byte of the file
       .max_cpu_s = 20});
}
