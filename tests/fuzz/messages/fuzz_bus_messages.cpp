// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Changed messages of every type at the edge of the bus: no exception but WireError; what passes keeps its promises:
/// all that its sizes and offsets name is there.
#include <algorithm>
#include <functional>

#include "common/bus/message_cdr.hpp"
#include "common/bus/message_screen.hpp"
#include "tests/fuzz/fuzz_loop.hpp"
#include "tests/unit/bus/message_walk.hpp"

namespace rtd::bus {
namespace {

std::uint64_t touched = 0;  ///< so that nothing below is left out

/// Reads what a message promises to hold.
void use(const auto&) {}
void use(const msg::Image& image) {
  for (std::uint32_t row = 0; row < image.height; ++row) {
    const std::uint8_t* const pixels = image.data.data() + std::size_t{row} * image.step;
    touched += pixels[0] + pixels[image.width - 1];
  }
}
void use(const msg::PointCloud2& cloud) {
  for (std::uint32_t row = 0; row < cloud.height && cloud.width > 0; ++row) {
    const std::size_t last = std::size_t{row} * cloud.row_step + std::size_t{cloud.width - 1} * cloud.point_step;
    for (const msg::PointField& field : cloud.fields) touched += *(cloud.data.data() + last + field.offset);
  }
}
void use(const msg::OccupancyGrid& grid) {
  if (!grid.data.empty()) touched += static_cast<std::uint8_t>(*(grid.data.data() + grid.data.size() - 1));
}
void use(const msg::MapUpdate& update) {
  for (const msg::MapKeyframe& keyframe : update.keyframes) touched += keyframe.points_m.size() / 3;
}
void use(const msg::FeatureFrame& frame) {
  for (std::uint32_t i = 0; i < frame.count; ++i) touched += static_cast<std::uint64_t>(frame.features[i].u_px + 1e6F);
}
template <std::uint32_t kWidth, std::uint32_t kHeight>
void use(const msg::SizedFrame<kWidth, kHeight>& frame) {
  touched += frame.depth[frame.width * frame.height - 1];
}
void use(const msg::TrackingResult& result) {
  touched += static_cast<std::uint64_t>(result.finished_ns - result.published_ns);  // UBSan looks for an overflow
}

/// A type and its messages as bytes.
struct Type {
  io::Bytes seed;
  std::function<bool(ros::Bytes)> passes;
};

template <class T>
bool passes(ros::Bytes cdr) {
  static const auto message = std::make_unique<T>();
  if (!read_cdr(cdr, *message)) return false;
  if (MessageScreen(MessageTraits<T>::kId).implausible_field(message.get(), {})) return false;
  use(*message);
  return true;
}

std::vector<Type> all_types() {
  std::vector<Type> types;
  walk::for_each_type(MessageTypes(), [&]<class T>() {
    const auto message = walk::plausible_message<T>();
    std::vector<std::uint8_t> cdr(cdr_size(*message));
    write_cdr(*message, cdr);
    const auto bytes = std::as_bytes(std::span(cdr));
    types.push_back({{bytes.begin(), bytes.end()}, passes<T>});
  });
  return types;
}

/// The place of the type, then its changed message. Large messages change in their first bytes, where their sizes are.
io::Bytes make(const std::vector<Type>& types, fuzz::Random& random) {
  constexpr std::size_t kHead = 512;
  const std::size_t place = random() % types.size();
  const io::Bytes& seed = types[place].seed;
  const io::Bytes head(seed.begin(), seed.begin() + static_cast<std::ptrdiff_t>(std::min(kHead, seed.size())));
  const bool large = seed.size() > kHead;
  io::Bytes changed = random() % 16 == 0 ? head : fuzz::mutate(head, head, random);
  if (large) changed.resize(kHead);
  io::Bytes input(1, static_cast<std::byte>(place));
  input.insert(input.end(), changed.begin(), changed.end());
  if (large) input.insert(input.end(), seed.begin() + kHead, seed.end());
  return input;
}

}  // namespace
}  // namespace rtd::bus

int main(int argc, char** argv) {
  using namespace rtd;
  const std::vector<bus::Type> types = bus::all_types();
  std::uint64_t passed = 0;
  return fuzz::run_fuzz(
      argc, argv,
      {.failed_path = "fuzz_bus_messages_failed.bin",
       .make = [&](fuzz::Random& random) { return bus::make(types, random); },
       .test = [&](const io::Bytes& input, fuzz::Random&) -> std::string {
         const auto* const bytes = reinterpret_cast<const std::uint8_t*>(input.data());
         passed += types[bytes[0]].passes({bytes + 1, input.size() - 1});
         return "";
       },
       .counted = [&] { return std::to_string(passed) + " passed, " + std::to_string(bus::touched) + " touched"; }});
}
