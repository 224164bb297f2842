// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/openni2/openni2_device.hpp"

#include <fmt/format.h>
#include <openni2/OpenNI.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace rtd::camera {
namespace {

constexpr float kImageByImage = -1;                      // speed of a file: each read gives the next image
constexpr std::chrono::milliseconds kDamagedAfter{500};  // a file without an image for so long gives none any more
constexpr std::chrono::milliseconds kPlayerRests{50};    // before the streams of a file go
constexpr double kMillimetreM = 0.001, kTenthOfMillimetreM = 0.0001;

/// "1d27/0609@1/5" (vendor/product@bus/device, OpenNI2's name of a USB device) -> "/dev/bus/usb/001/005"; empty when
/// the name is of another kind.
std::optional<std::string> usb_node(const std::string& uri) {
  unsigned vendor = 0, product = 0, bus = 0, device = 0;
  int used = 0;
  const int fields = std::sscanf(uri.c_str(), "%4x/%4x@%3u/%3u%n", &vendor, &product, &bus, &device, &used);
  if (fields != 4 || static_cast<std::size_t>(used) != uri.size()) return std::nullopt;
  return fmt::format("/dev/bus/usb/{:03}/{:03}", bus, device);
}

/// Cause and fix for a device file that exists but may not be opened.
std::string no_permission(const std::string& device, const std::string& node) {
  return fmt::format(
      "{}: no permission to open {}: add the user to the group 'video' (sudo usermod -aG video $USER, then log in "
      "again) and install the udev rule: sudo cp deploy/udev/60-rtd-cameras.rules /etc/udev/rules.d/ && sudo udevadm "
      "control --reload && sudo udevadm trigger",
      device, node);
}

/// A mode as OpenNI2 and as we name it.
struct NamedMode {
  openni::VideoMode theirs;
  DeviceMode ours;
};

const char* format_name(openni::PixelFormat format) {
  switch (format) {
    case openni::PIXEL_FORMAT_RGB888:
      return "RGB8";
    case openni::PIXEL_FORMAT_YUV422:
      return "UYVY";
    case openni::PIXEL_FORMAT_YUYV:
      return "YUYV";
    case openni::PIXEL_FORMAT_JPEG:
      return "MJPG";
    case openni::PIXEL_FORMAT_GRAY8:
      return "GREY";
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      return "Z16";
    default:
      return "other";
  }
}

openni::SensorType sensor_of(Stream stream) {
  return stream == Stream::kColor ? openni::SENSOR_COLOR : openni::SENSOR_DEPTH;
}

std::vector<NamedMode> modes_of(openni::Device& device, Stream stream) {
  std::vector<NamedMode> modes;
  const openni::SensorInfo* const sensor = device.getSensorInfo(sensor_of(stream));
  if (sensor == nullptr) return modes;
  const openni::Array<openni::VideoMode>& theirs = sensor->getSupportedVideoModes();
  for (int i = 0; i < theirs.getSize(); ++i) {
    const openni::VideoMode& mode = theirs[i];
    const cv::Size size_px(mode.getResolutionX(), mode.getResolutionY());
    modes.push_back({mode, {stream, size_px, static_cast<double>(mode.getFps()), format_name(mode.getPixelFormat())}});
  }
  // Millimetres reach farther than tenths of them: the first of equal modes is chosen.
  std::ranges::stable_sort(modes, {}, [](const NamedMode& mode) {
    return mode.theirs.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM ? 1 : 0;
  });
  return modes;
}

std::vector<DeviceMode> ours_of(const std::vector<NamedMode>& modes) {
  std::vector<DeviceMode> ours;
  for (const NamedMode& mode : modes) ours.push_back(mode.ours);
  return ours;
}

/// Pinhole of the field of view that the driver states; empty when it states none.
std::optional<geometry::CameraModel> lens_of(const openni::VideoStream& stream, cv::Size size_px) {
  const double horizontal_rad = stream.getHorizontalFieldOfView(), vertical_rad = stream.getVerticalFieldOfView();
  if (!(horizontal_rad > 0) || !(vertical_rad > 0)) return std::nullopt;
  geometry::CameraModel::Parameters p;
  p.width = size_px.width;
  p.height = size_px.height;
  p.fx = size_px.width / (2 * std::tan(horizontal_rad / 2));
  p.fy = size_px.height / (2 * std::tan(vertical_rad / 2));
  p.cx = (size_px.width - 1) / 2.0;
  p.cy = (size_px.height - 1) / 2.0;
  return geometry::CameraModel(p);
}

/// OpenNI2's drivers, loaded while one of these lives.
class Library {
 public:
  Library() {
    if (openni::OpenNI::initialize() == openni::STATUS_OK) return;
    const std::string cause = openni::OpenNI::getExtendedError();
    openni::OpenNI::shutdown();
    throw DeviceError(DeviceProblem::kAbsent, "OpenNI2 has no drivers (package libopenni2-0): " + cause);
  }
  ~Library() { openni::OpenNI::shutdown(); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

/// Notes that a device was unplugged or a file has ended. Called by OpenNI2's threads.
class Watch final : public openni::OpenNI::DeviceDisconnectedListener,
                    public openni::OpenNI::DeviceStateChangedListener {
 public:
  explicit Watch(std::string uri) : uri_(std::move(uri)) {
    openni::OpenNI::addDeviceDisconnectedListener(this);
    openni::OpenNI::addDeviceStateChangedListener(this);
  }
  ~Watch() {
    openni::OpenNI::removeDeviceStateChangedListener(this);
    openni::OpenNI::removeDeviceDisconnectedListener(this);
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  bool unplugged() const { return unplugged_; }
  bool ended() const { return ended_; }

 private:
  void onDeviceDisconnected(const openni::DeviceInfo* info) override {
    if (uri_ == info->getUri()) unplugged_ = true;
  }
  void onDeviceStateChanged(const openni::DeviceInfo* info, openni::DeviceState state) override {
    if (uri_ != info->getUri()) return;
    if (state == openni::DEVICE_STATE_EOF) ended_ = true;
    if (state == openni::DEVICE_STATE_ERROR || state == openni::DEVICE_STATE_NOT_READY) unplugged_ = true;
  }

  const std::string uri_;
  std::atomic<bool> unplugged_{false}, ended_{false};
};

class OpenNi2Device final : public LiveDevice {
 public:
  explicit OpenNi2Device(std::string uri) : uri_(std::move(uri)) {}
  ~OpenNi2Device() override { close(); }

  std::string name() const override { return "openni2:" + uri_; }
  void open() override;
  std::vector<DeviceMode> modes();
  std::optional<DeviceSetup> start(const ModeRequest& request) override;
  std::optional<DeviceImage> read(std::chrono::milliseconds timeout) override;
  void close() noexcept override;

 private:
  DeviceError refusal() const;
  NamedMode choose(Stream stream, const ModeRequest& request);
  void start(openni::VideoStream& stream, const NamedMode& mode);
  void register_depth();
  DeviceImage to_image(const openni::VideoFrameRef& frame, Stream stream) const;

  const std::string uri_;
  std::unique_ptr<Library> library_;
  std::unique_ptr<Watch> watch_;
  openni::Device device_;
  openni::VideoStream color_, depth_;
  std::chrono::milliseconds silent_{0};
};

void OpenNi2Device::open() {
  library_ = std::make_unique<Library>();
  if (device_.open(uri_.empty() ? openni::ANY_DEVICE : uri_.c_str()) != openni::STATUS_OK) throw refusal();
  watch_ = std::make_unique<Watch>(device_.getDeviceInfo().getUri());
}

DeviceError OpenNi2Device::refusal() const {
  std::string cause = openni::OpenNI::getExtendedError();
  std::erase_if(cause, [](char c) { return c == '\n' || c == '\t'; });
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  std::string uris;
  for (int i = 0; i < found.getSize(); ++i) {
    const std::string uri = found[i].getUri();
    uris += ' ' + uri;
    if (!uri_.empty() && uri != uri_) continue;
    const auto node = usb_node(uri);
    if (node && access(node->c_str(), R_OK | W_OK) != 0 && errno == EACCES)
      return {DeviceProblem::kNoPermission, no_permission("openni2:" + uri, *node)};
    return {
        DeviceProblem::kBusy,
        fmt::format("openni2:{} is plugged in but cannot be opened ({}): another program uses it; end it", uri, cause)};
  }
  if (!uri_.empty() && std::filesystem::exists(uri_))
    return {DeviceProblem::kUnsupportedMode,
            fmt::format("{} is not an .oni file that OpenNI2 can play: {}", uri_, cause)};
  if (uri_.ends_with(".oni")) return {DeviceProblem::kUnsupportedMode, "there is no file " + uri_};
  if (found.getSize() > 0)
    return {DeviceProblem::kAbsent, fmt::format("openni2:{} is not plugged in; cameras found:{}", uri_, uris)};
  return {DeviceProblem::kAbsent, fmt::format("no OpenNI2 camera{}{} is plugged in", uri_.empty() ? "" : " ", uri_)};
}

std::vector<DeviceMode> OpenNi2Device::modes() {
  std::vector<DeviceMode> all = ours_of(modes_of(device_, Stream::kColor));
  const std::vector<DeviceMode> depth = ours_of(modes_of(device_, Stream::kDepth));
  all.insert(all.end(), depth.begin(), depth.end());
  return all;
}

NamedMode OpenNi2Device::choose(Stream stream, const ModeRequest& request) {
  const std::vector<NamedMode> modes = modes_of(device_, stream);
  const DeviceMode best = choose_mode(ours_of(modes), stream, request, name());
  return *std::ranges::find_if(modes, [&](const NamedMode& mode) {
    return mode.ours.size_px == best.size_px && mode.ours.fps == best.fps && mode.ours.format == best.format;
  });
}

std::optional<DeviceSetup> OpenNi2Device::start(const ModeRequest& request) {
  const NamedMode color = choose(Stream::kColor, request);
  const NamedMode depth = choose(Stream::kDepth, {color.ours.size_px.width, color.ours.size_px.height, color.ours.fps});
  for (const auto& [stream, kind] : {std::pair(&color_, Stream::kColor), std::pair(&depth_, Stream::kDepth)}) {
    if (stream->create(device_, sensor_of(kind)) != openni::STATUS_OK) {
      throw DeviceError(
          DeviceProblem::kUnsupportedMode,
          fmt::format("{} gives no {} stream: {}", name(), to_string(kind), openni::OpenNI::getExtendedError()));
    }
  }
  if (device_.isFile()) {
    device_.getPlaybackControl()->setSpeed(kImageByImage);
    device_.getPlaybackControl()->setRepeatEnabled(false);
  } else {
    register_depth();
  }
  start(color_, color);
  start(depth_, depth);
  const bool fine = depth.theirs.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM;
  silent_ = std::chrono::milliseconds(0);
  return DeviceSetup{color.ours, depth.ours, fine ? kTenthOfMillimetreM : kMillimetreM,
                     lens_of(color_, color.ours.size_px)};
}

void OpenNi2Device::register_depth() {
  constexpr auto kMode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  if (!device_.isImageRegistrationModeSupported(kMode) ||
      device_.setImageRegistrationMode(kMode) != openni::STATUS_OK) {
    throw DeviceError(DeviceProblem::kUnsupportedMode,
                      name() + " cannot register depth to colour: use a camera whose driver does");
  }
  device_.setDepthColorSyncEnabled(true);  // refused by cameras that cannot: their images pair by stamps
}

void OpenNi2Device::start(openni::VideoStream& stream, const NamedMode& mode) {
  if (!device_.isFile()) {
    stream.setVideoMode(mode.theirs);
    stream.setMirroringEnabled(false);
  }
  if (stream.start() == openni::STATUS_OK) return;
  throw DeviceError(
      DeviceProblem::kBandwidth,
      fmt::format("{} cannot start its {} stream of {} x {} px at {:g} Hz ({}): plug it into a USB port of "
                  "its own, without a hub, or choose a smaller mode (?width=&height=&fps=)",
                  name(), to_string(mode.ours.stream), mode.ours.size_px.width, mode.ours.size_px.height, mode.ours.fps,
                  openni::OpenNI::getExtendedError()));
}

std::optional<DeviceImage> OpenNi2Device::read(std::chrono::milliseconds timeout) {
  if (watch_->unplugged()) throw DeviceError(DeviceProblem::kAbsent, name() + " was unplugged");
  // OpenNI2 reports the end of a file; at a damaged record it stops silently.
  const bool ended = watch_->ended() || (device_.isFile() && silent_ > kDamagedAfter);
  std::array<openni::VideoStream*, 2> streams = {&color_, &depth_};
  int ready = -1;
  const int timeout_ms = ended ? 0 : static_cast<int>(timeout.count());
  const openni::Status status = openni::OpenNI::waitForAnyStream(streams.data(), 2, &ready, timeout_ms);
  if (status == openni::STATUS_TIME_OUT) {
    if (ended) throw DeviceError(DeviceProblem::kEnded, name() + " is at its end");
    silent_ += timeout;
    return std::nullopt;
  }
  silent_ = std::chrono::milliseconds(0);
  openni::VideoFrameRef frame;
  if (status != openni::STATUS_OK || ready < 0 ||
      streams.at(static_cast<std::size_t>(ready))->readFrame(&frame) != openni::STATUS_OK) {
    throw DeviceError(DeviceProblem::kAbsent,
                      fmt::format("{} gives no image: {}", name(), openni::OpenNI::getExtendedError()));
  }
  return to_image(frame, ready == 0 ? Stream::kColor : Stream::kDepth);
}

DeviceImage OpenNi2Device::to_image(const openni::VideoFrameRef& frame, Stream stream) const {
  DeviceImage image{stream, static_cast<std::int64_t>(frame.getTimestamp()) * 1000, {}};
  const auto* const data = static_cast<const std::uint8_t*>(frame.getData());
  image.message.bytes.assign(data, data + frame.getDataSize());
  return image;
}

void OpenNi2Device::close() noexcept {
  watch_.reset();
  for (openni::VideoStream* const stream : {&color_, &depth_}) {
    if (stream->isValid()) stream->stop();
  }
  // The player of files looks at its streams without a lock, but sleeps while none is started.
  if (device_.isValid() && device_.isFile()) std::this_thread::sleep_for(kPlayerRests);
  for (openni::VideoStream* const stream : {&color_, &depth_}) {
    if (stream->isValid()) stream->destroy();
  }
  if (device_.isValid()) device_.close();
  library_.reset();
}

FoundCamera look_at(const openni::DeviceInfo& info) {
  FoundCamera camera{
      std::string("openni2:") + info.getUri(), fmt::format("{} {}", info.getVendor(), info.getName()), {}, {}};
  OpenNi2Device device(info.getUri());
  try {
    device.open();
    camera.modes = device.modes();
  } catch (const DeviceError& error) {
    camera.problem = error.what();
  }
  return camera;
}

}  // namespace

std::unique_ptr<LiveDevice> make_openni2_device(const DeviceUri& uri) {
  return std::make_unique<OpenNi2Device>(uri.device);
}

std::vector<FoundCamera> find_openni2_cameras() {
  try {
    const Library library;
    openni::Array<openni::DeviceInfo> infos;
    openni::OpenNI::enumerateDevices(&infos);
    std::vector<FoundCamera> cameras;
    for (int i = 0; i < infos.getSize(); ++i) cameras.push_back(look_at(infos[i]));
    return cameras;
  } catch (const DeviceError&) {
    return {};  // no driver, so no camera
  }
}

bool supports_openni2() {
  return true;
}

}  // namespace rtd::camera
