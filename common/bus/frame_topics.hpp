// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <variant>

#include "common/bus/bus.hpp"

namespace rtd::bus {

namespace topics {
/// One topic per size class of frames, smallest first.
inline constexpr auto kFrames = std::make_tuple(kFrame, kFrame848, kFrame1280, kFrame1920);
}  // namespace topics

/// A frame topic, for programs that know its type only by name.
struct FrameTopic {
  const char* name;
  MessageId type;
  std::size_t message_bytes;
};

/// The topics of all size classes, smallest first.
inline std::array<FrameTopic, 4> frame_topics() {
  return std::apply(
      []<class... T>(const Topic<T>&... topic) {
        return std::array<FrameTopic, 4>{FrameTopic{topic.name, MessageTraits<T>::kId, sizeof(T)}...};
      },
      topics::kFrames);
}

/// Receives frames of every size class until destroyed. Frames are immutable and may be kept. Each class has a reader
/// of its own, so while two cameras of different classes run, two callbacks may run at a time; otherwise as Reader.
class FrameReader {
 public:
  using OnFrame = std::function<void(std::shared_ptr<const msg::FrameView>)>;
  FrameReader() = default;
  FrameReader(Bus& bus, const OnFrame& on_frame, const StatusCallbacks& callbacks = {}) {
    std::apply([&](const auto&... topic) { readers_ = {read(bus, topic, on_frame, callbacks)...}; }, topics::kFrames);
  }
  explicit operator bool() const { return static_cast<bool>(std::get<0>(readers_)); }
  /// Writers matched now, of all classes.
  int matched() const {
    return std::apply([](const auto&... reader) { return (reader.matched() + ...); }, readers_);
  }

 private:
  template <class T>
  static Reader<T> read(Bus& bus, const Topic<T>& topic, const OnFrame& on_frame, const StatusCallbacks& callbacks) {
    return bus.reader(
        topic,
        [on_frame](const std::shared_ptr<const T>& frame) {
          on_frame(std::make_shared<const msg::FrameView>(*frame, frame));
        },
        callbacks);
  }

  std::tuple<Reader<msg::RgbdFrame>, Reader<msg::RgbdFrame848>, Reader<msg::RgbdFrame1280>, Reader<msg::RgbdFrame1920>>
      readers_;
};

/// Publishes frames of one size class: the smallest that the first frame fits into. One thread.
class FrameWriter {
 public:
  FrameWriter() = default;
  /// For images of this size. Throws BusError when no class is large enough.
  FrameWriter(Bus& bus, std::uint32_t width, std::uint32_t height, StatusCallbacks callbacks = {}) {
    const bool found = std::apply(
        [&](const auto&... topic) { return (open(bus, topic, width, height, callbacks) || ...); }, topics::kFrames);
    if (!found) {
      throw BusError("no frame topic carries images of " + std::to_string(width) + " x " + std::to_string(height) +
                     " px");
    }
  }
  int matched() const {
    return std::visit([](const auto& writer) { return matched(writer); }, writer_);
  }
  /// Lends a frame, lets `fill` (a generic callable) fill every field, and writes it. False when the bus did not take
  /// it.
  template <class Fill>
  bool write(Fill&& fill) {
    return std::visit([&](auto& writer) { return write_with(writer, fill); }, writer_);
  }

 private:
  using AnyWriter = std::variant<std::monostate, Writer<msg::RgbdFrame>, Writer<msg::RgbdFrame848>,
                                 Writer<msg::RgbdFrame1280>, Writer<msg::RgbdFrame1920>>;
  template <class T>
  bool open(Bus& bus, const Topic<T>& topic, std::uint32_t width, std::uint32_t height,
            const StatusCallbacks& callbacks) {
    if (!msg::fits(width, height, T::kPixels)) return false;
    writer_ = bus.writer(topic, callbacks);
    return true;
  }
  static int matched(const std::monostate&) { return 0; }
  template <class T>
  static int matched(const Writer<T>& writer) {
    return writer.matched();
  }
  template <class Fill>
  static bool write_with(std::monostate&, Fill&) {
    return false;
  }
  template <class T, class Fill>
  static bool write_with(Writer<T>& writer, Fill& fill) {
    Loan<T> frame = writer.loan();
    if (frame.operator->() == nullptr) return false;
    fill(*frame);
    return writer.write(std::move(frame));
  }

  AnyWriter writer_;
};

}  // namespace rtd::bus
