// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed networks, for what reads them before an engine does: no exception; sizes and heads that are read are sound.
#include "services/detector/core/onnx_file.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/support/detector/tiny_network.hpp"

namespace rtd::detector {
namespace {

std::vector<io::Bytes> seeds() {
  test::TinyNetwork small{.width_px = 32, .height_px = 32, .class_count = 1, .strides = {8}};
  test::TinyNetwork free = small, named = small;
  free.fixed_size = false;
  free.free_batch = true;
  free.reshape = {0, -1};
  free.reshape_by_node = true;
  named.metadata = {{"rtd.class_names", "person\nchair"}, {"rtd.heads", "8: 10,13 16,30 33,23"}};
  std::vector<io::Bytes> files;
  for (const test::TinyNetwork& network : {small, free, named})
    files.push_back(fuzz::bytes_of(test::tiny_network_onnx(network)));
  return files;
}

/// Why what was read cannot be; empty when it can.
std::string unsound(const OnnxFile& file) {
  if (file.input && (file.input->width_px <= 0 || file.input->height_px <= 0)) return "it has an input of no size";
  const auto heads = file.metadata.find("rtd.heads");
  if (heads == file.metadata.end()) return "";
  for (const HeadLayout& head : parse_heads(heads->second))
    if (head.stride_px <= 0) return "it has a head without cells";
  return "";
}

std::string try_input(const io::Bytes& input, std::uint64_t& models) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(input.data());
  const OnnxFile file = read_onnx_file(bytes, input.size());
  models += file.has_graph ? 1 : 0;
  return unsound(file);
}

}  // namespace
}  // namespace rtd::detector

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<io::Bytes> files = detector::seeds();
  std::uint64_t models = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_onnx_failed.onnx",
       .make = [&](fuzz::Random& random) { return fuzz::mutate_one(files, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) { return detector::try_input(input, models); },
       .counted = [&] { return std::to_string(models) + " of them models"; },
       .max_allocated = 1 << 20,
       .max_allocated_per_byte = 400});  // an empty name takes two bytes of a file and a text of 32 in memory
}
