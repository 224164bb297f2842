// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/realsense/realsense_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "common/ros_codec/wire.hpp"
#include "common/service/log.hpp"
#include "services/camera/core/live/device_modes.hpp"
#include "services/camera/realsense/realsense_bus.hpp"

namespace rtd::camera {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using namespace realsense;

constexpr milliseconds kSearch{1000};       // for a device and its description; DeviceSource tries again
constexpr milliseconds kOtherDevices{300};  // after the first: whether there are others
constexpr milliseconds kAnswer{400};        // to a request, which is sent up to kRequests times
constexpr int kRequests = 3;
constexpr milliseconds kFirstImages{2000};

std::string label(const DeviceInfo& info) {
  return fmt::format("{} (serial {})", info.name, info.serial.empty() ? "unknown" : info.serial);
}

/// The bytes of an image without those between its rows; unchanged when they are not those of its size.
std::vector<std::uint8_t> packed_rows(msg::Image& image) {
  const std::string format = pixel_format_of(image.encoding);
  const std::size_t pixel_bytes = format == "GREY" ? 1 : (format == "RGB8" || format == "BGR8") ? 3 : 2;
  const std::size_t row = pixel_bytes * image.width, step = image.height == 0 ? 0 : image.data.size() / image.height;
  if (step <= row || step * image.height != image.data.size()) return std::move(image.data);
  std::vector<std::uint8_t> packed;
  packed.reserve(row * image.height);
  for (std::size_t y = 0; y < image.height; ++y) {
    const auto begin = image.data.begin() + static_cast<std::ptrdiff_t>(y * step);
    packed.insert(packed.end(), begin, begin + static_cast<std::ptrdiff_t>(row));
  }
  return packed;
}

class RealsenseDevice final : public LiveDevice {
 public:
  RealsenseDevice(const bus::BusOptions& options, std::string serial)
      : serial_(std::move(serial)),
        domain_(options.domain),
        loopback_only_(options.network.loopback_only),
        devices_(options) {}
  ~RealsenseDevice() override { close(); }

  std::string name() const override { return "realsense-dds:" + serial_; }
  void open() override;
  std::optional<DeviceSetup> start(const ModeRequest& asked) override;
  std::optional<DeviceImage> read(milliseconds timeout) override;
  void close() noexcept override;

 private:
  /// The one that open() has found. Throws kAbsent when it has gone.
  Devices::Device& device();
  bool wanted(const DeviceInfo& info) const { return serial_.empty() || info.serial == serial_; }
  std::string choose() const;
  std::string whereabouts() const;
  void request(const DeviceMode& color, const DeviceMode& depth);
  /// The mode in which a stream really comes, by its first image.
  DeviceMode first_image(Stream stream, const DeviceMode& asked);
  std::optional<DeviceImage> take(const Event& event);
  DepthCamera depth_camera(const DeviceMode& depth);

  const std::string serial_;
  const std::uint32_t domain_;
  const bool loopback_only_;
  mutable Devices devices_;
  std::string root_, color_topic_, depth_topic_;
  std::map<Stream, DeviceMode> coming_;  ///< as the images are
  std::string refused_;                  ///< why the modes asked for are not those that come
};

std::string RealsenseDevice::whereabouts() const {
  std::string others;
  for (const auto& [root, device] : devices_.all())
    others += (others.empty() ? "; there is " : ", ") + label(device.info);
  return fmt::format("no RealSense device{} announces itself on {} in DDS domain {}{}{}",
                     serial_.empty() ? "" : " of serial " + serial_, kDeviceInfoTopic, domain_,
                     loopback_only_ ? " on this host (--profile lan: also on the network)" : "", others);
}

std::string RealsenseDevice::choose() const {
  std::string chosen, list;
  int matches = 0;
  for (const auto& [root, device] : devices_.all()) {
    if (!wanted(device.info)) continue;
    chosen = root;
    list += (++matches == 1 ? "" : ", ") + label(device.info);
  }
  if (matches > 1) {
    throw DeviceError(DeviceProblem::kUnsupportedMode,
                      fmt::format("{} RealSense devices are in DDS domain {}: {}; name one, realsense-dds:SERIAL",
                                  matches, domain_, list));
  }
  if (matches == 0) throw DeviceError(DeviceProblem::kAbsent, whereabouts());
  return chosen;
}

void RealsenseDevice::open() {
  const auto found = [this] {
    return std::ranges::any_of(devices_.all(), [this](const auto& item) { return wanted(item.second.info); });
  };
  if (devices_.wait(kSearch, found) && serial_.empty()) devices_.wait(kOtherDevices, [] { return false; });
  root_ = choose();
  const auto described = [this] { return !devices_.all().contains(root_) || device().description.complete(); };
  if (devices_.wait(kSearch, described)) return static_cast<void>(device());
  throw DeviceError(DeviceProblem::kAbsent,
                    fmt::format("{} does not describe its streams on {}/notification", label(device().info), root_));
}

Devices::Device& RealsenseDevice::device() {
  const auto found = devices_.all().find(root_);
  if (found == devices_.all().end()) throw DeviceError(DeviceProblem::kAbsent, name() + " was unplugged");
  return found->second;
}

std::optional<DeviceSetup> RealsenseDevice::start(const ModeRequest& asked) {
  const std::vector<DeviceMode> all = device().description.modes();
  const DeviceMode color = choose_mode(all, Stream::kColor, asked, name());
  DeviceMode depth;
  try {
    depth = choose_mode(all, Stream::kDepth, {color.size_px.width, color.size_px.height, color.fps}, name());
  } catch (const DeviceError&) {
    depth = choose_mode(all, Stream::kDepth, {0, 0, color.fps}, name());  // registered, so any size will do
  }
  request(color, depth);
  coming_.clear();
  color_topic_ = stream_topic(device().info, device().description.color().name);
  depth_topic_ = stream_topic(device().info, device().description.depth().name);
  devices_.subscriptions().read(color_topic_, true);
  devices_.subscriptions().read(depth_topic_, true);
  DeviceSetup setup;
  setup.color = first_image(Stream::kColor, color);
  setup.depth = first_image(Stream::kDepth, depth);
  setup.depth_scale_m = device().description.depth().unit_m;
  setup.camera = device().description.color().camera(setup.color.size_px);
  setup.depth_camera = depth_camera(setup.depth);
  return setup;
}

void RealsenseDevice::request(const DeviceMode& color, const DeviceMode& depth) {
  const auto control = devices_.subscriptions().writer({root_ + "/control", kFlexibleType});
  const auto matched = [&] { return control->matched() > 0; };
  devices_.wait(kSearch, matched);
  device().reply.reset();
  refused_.clear();
  const std::vector<std::uint8_t> message = write_flexible(open_streams(device().description, color, depth));
  const auto replied = [this] { return device().reply.has_value(); };
  for (int i = 0; i < kRequests && matched() && !replied(); ++i) {  // a device that is just found may miss the first
    control->write(std::as_bytes(std::span(message)));
    devices_.wait(kAnswer, replied);
  }
  if (!replied()) {
    SPDLOG_WARN("event=no_reply device=\"{}\" request=open-streams: it streams what it is set to", name());
    return;
  }
  const nlohmann::json& reply = *device().reply;
  if (!reply.contains("status") || reply["status"] == "ok") return;
  refused_ = reply.value("explanation", reply["status"].dump());
}

DeviceMode RealsenseDevice::first_image(Stream stream, const DeviceMode& asked) {
  const Clock::time_point until = Clock::now() + kFirstImages;
  while (!coming_.contains(stream)) {
    const std::optional<Event> event = devices_.next(until);
    if (event) static_cast<void>(take(*event));
    if (event) continue;
    const std::string& topic = stream == Stream::kColor ? color_topic_ : depth_topic_;
    throw DeviceError(DeviceProblem::kAbsent,
                      fmt::format("{} sends no {} image on {}{}", name(), to_string(stream), topic,
                                  devices_.subscriptions().published(topic) ? "" : ": it does not publish it"));
  }
  DeviceMode mode = coming_[stream];
  mode.fps = asked.fps;
  const bool as_asked = mode.size_px == asked.size_px && mode.format == asked.format;
  if (!as_asked) {
    SPDLOG_WARN("event=other_mode device=\"{}\" stream={} asked=\"{}x{} {}\" gives=\"{}x{} {}\" cause=\"{}\"", name(),
                to_string(stream), asked.size_px.width, asked.size_px.height, asked.format, mode.size_px.width,
                mode.size_px.height, mode.format, refused_);
  }
  if (readable(mode.format, stream)) return mode;
  throw DeviceError(DeviceProblem::kUnsupportedMode,
                    fmt::format("{} sends {} images as {}, readable are {}: another program may have chosen it", name(),
                                to_string(stream), mode.format, readable_formats(stream)));
}

DepthCamera RealsenseDevice::depth_camera(const DeviceMode& depth) {
  const Description& description = device().description;
  const auto camera = description.depth().camera(depth.size_px);
  const auto T_color_depth = description.T_color_depth();
  if (camera && T_color_depth) return {*camera, *T_color_depth};
  throw DeviceError(DeviceProblem::kUnsupportedMode,
                    fmt::format("{} does not say {}: its depth cannot be registered to colour", name(),
                                camera ? "where its depth camera is" : "the intrinsics of its depth camera"));
}

std::optional<DeviceImage> RealsenseDevice::read(milliseconds timeout) {
  const Clock::time_point until = Clock::now() + timeout;
  while (true) {
    const std::optional<Event> event = devices_.next(until);
    static_cast<void>(device());
    for (const std::string& topic : {color_topic_, depth_topic_}) {
      if (!devices_.subscriptions().published(topic)) {
        throw DeviceError(DeviceProblem::kAbsent, fmt::format("{} was unplugged: {} is gone", name(), topic));
      }
    }
    if (!event) return std::nullopt;
    if (std::optional<DeviceImage> image = take(*event)) return image;
  }
}

std::optional<DeviceImage> RealsenseDevice::take(const Event& event) {
  try {
    if (event.topic != color_topic_ && event.topic != depth_topic_) return std::nullopt;
    const Stream stream = event.topic == color_topic_ ? Stream::kColor : Stream::kDepth;
    auto image = ros::decode<msg::Image>(ros::Wire::kCdr, event.cdr());
    const cv::Size size_px(static_cast<int>(image.width), static_cast<int>(image.height));
    const DeviceMode mode{stream, size_px, 0, pixel_format_of(image.encoding)};
    const auto [known, first] = coming_.try_emplace(stream, mode);
    if (!first && (known->second.size_px != size_px || known->second.format != mode.format)) {
      throw DeviceError(DeviceProblem::kAbsent,
                        fmt::format("{} changed the mode of its {} images to {} x {} {}; it is started again", name(),
                                    to_string(stream), size_px.width, size_px.height, mode.format));
    }
    return DeviceImage{stream, msg::to_ns(image.header.stamp), {.bytes = packed_rows(image)}};
  } catch (const ros::WireError& error) {
    SPDLOG_WARN("event=image_refused topic={} cause=\"{}\"", event.topic, error.what());
    return std::nullopt;
  }
}

void RealsenseDevice::close() noexcept {
  devices_.subscriptions().read(color_topic_, false);
  devices_.subscriptions().read(depth_topic_, false);
}

}  // namespace

std::unique_ptr<LiveDevice> make_realsense_device(const bus::BusOptions& options, const std::string& serial) {
  return std::make_unique<RealsenseDevice>(options, serial);
}

std::vector<FoundCamera> find_realsense_cameras(const bus::BusOptions& options) {
  Devices devices(options);
  devices.wait(kSearch, [] { return false; });
  std::vector<FoundCamera> cameras;
  for (const auto& [root, device] : devices.all()) {
    FoundCamera camera{"realsense-dds:" + device.info.serial, device.info.name, device.description.modes(), {}};
    if (!device.description.complete())
      camera.problem = "it does not describe its streams on " + root + "/notification";
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace rtd::camera
