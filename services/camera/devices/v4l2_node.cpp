// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/v4l2_node.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "services/camera/devices/usb_access.hpp"

namespace rtd::camera {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr double kDefaultFps = 30;

struct KnownFormat {
  std::uint32_t fourcc;
  const char* name;
};
constexpr std::array kKnownFormats = {KnownFormat{V4L2_PIX_FMT_YUYV, "YUYV"},  KnownFormat{V4L2_PIX_FMT_UYVY, "UYVY"},
                                      KnownFormat{V4L2_PIX_FMT_MJPEG, "MJPG"}, KnownFormat{V4L2_PIX_FMT_RGB24, "RGB8"},
                                      KnownFormat{V4L2_PIX_FMT_BGR24, "BGR8"}, KnownFormat{V4L2_PIX_FMT_GREY, "GREY"},
                                      KnownFormat{V4L2_PIX_FMT_Z16, "Z16"}};

std::string v4l2_format_name(std::uint32_t fourcc) {
  const auto* const known = std::ranges::find(kKnownFormats, fourcc, &KnownFormat::fourcc);
  if (known != kKnownFormats.end()) return known->name;
  std::string text;
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>((fourcc >> shift) & 0x7F);
  return text;
}

std::uint32_t fourcc_of(const std::string& name) {
  const auto* const known =
      std::ranges::find_if(kKnownFormats, [&](const auto& format) { return format.name == name; });
  return known == kKnownFormats.end() ? 0 : known->fourcc;
}

/// Bytes of a pixel; 0 = compressed.
std::size_t pixel_bytes(std::uint32_t fourcc) {
  if (fourcc == V4L2_PIX_FMT_MJPEG) return 0;
  if (fourcc == V4L2_PIX_FMT_GREY) return 1;
  return fourcc == V4L2_PIX_FMT_RGB24 || fourcc == V4L2_PIX_FMT_BGR24 ? 3 : 2;
}

double rate_of(const v4l2_fract& interval) {
  return interval.numerator == 0 ? 0 : static_cast<double>(interval.denominator) / interval.numerator;
}

bool lies_in(std::uint32_t value, std::uint32_t least, std::uint32_t most, std::uint32_t step) {
  return value >= least && value <= most && (step <= 1 || (value - least) % step == 0);
}

template <class Struct>
Struct capture() {
  Struct argument{};
  argument.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return argument;
}

v4l2_buffer buffer_request(std::uint32_t index) {
  auto buffer = capture<v4l2_buffer>();
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

DeviceError V4l2Node::error_of(int code, const std::string& what) const {
  const std::string name = "v4l2:" + path_;
  switch (code) {
    case EACCES:
    case EPERM:
      return {DeviceProblem::kNoPermission, no_permission(name, path_)};
    case EBUSY:
      return {DeviceProblem::kBusy,
              fmt::format("{} is busy: another program uses it; end it ('fuser -v {}' names it)", name, path_)};
    case ENOSPC:
      return {DeviceProblem::kBandwidth,
              fmt::format("{}: the USB port has no bandwidth left for this mode (USB 2, a hub, another camera): use a "
                          "USB 3 port of its own, or a smaller mode (?width=&height=&fps=)",
                          name)};
    case ENOENT:
      return {DeviceProblem::kAbsent, name + " is not plugged in"};
    case ENODEV:
    case ENXIO:
      return {DeviceProblem::kAbsent, name + " was unplugged"};
    default:
      return {DeviceProblem::kAbsent, fmt::format("{}: {}: {}", name, what, std::strerror(code))};
  }
}

void V4l2Node::call(unsigned long request, void* argument, const char* what) {
  if (const int result = calls_.ioctl(fd_, request, argument); result < 0) throw error_of(-result, what);
}

void V4l2Node::open() {
  close();
  fd_ = calls_.open(path_);
  if (fd_ < 0) throw error_of(-fd_, "it cannot be opened");
  v4l2_capability capability{};
  const int result = calls_.ioctl(fd_, VIDIOC_QUERYCAP, &capability);
  if (result == -ENOTTY || result == -EINVAL)
    throw DeviceError(DeviceProblem::kUnsupportedMode, path_ + " is not a V4L2 device");
  if (result < 0) throw error_of(-result, "it does not say what it is");
  constexpr std::uint32_t kNeeded = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  const bool by_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  if (((by_node ? capability.device_caps : capability.capabilities) & kNeeded) != kNeeded) {
    throw DeviceError(DeviceProblem::kUnsupportedMode,
                      path_ + " does not capture video: another node of the camera does (`rtd doctor` lists them)");
  }
  card_ = reinterpret_cast<const char*>(capability.card);
  bus_ = reinterpret_cast<const char*>(capability.bus_info);
}

void V4l2Node::close() noexcept {
  if (streaming_) {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    calls_.ioctl(fd_, VIDIOC_STREAMOFF, &type);
    streaming_ = false;
  }
  for (const Buffer& buffer : buffers_) calls_.unmap(buffer.data, buffer.bytes);
  buffers_.clear();
  if (fd_ >= 0) calls_.close(fd_);
  fd_ = -1;
}

std::vector<DeviceMode> V4l2Node::modes() {
  std::vector<DeviceMode> modes;
  for (std::uint32_t i = 0;; ++i) {
    auto format = capture<v4l2_fmtdesc>();
    format.index = i;
    if (calls_.ioctl(fd_, VIDIOC_ENUM_FMT, &format) < 0) return modes;
    add_sizes(format.pixelformat, modes);
  }
}

void V4l2Node::add_sizes(std::uint32_t format, std::vector<DeviceMode>& modes) {
  constexpr std::array<std::array<std::uint32_t, 2>, 4> kUsualSizes = {
      {{320, 240}, {640, 480}, {848, 480}, {1280, 720}}};
  for (std::uint32_t i = 0;; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = format;
    if (calls_.ioctl(fd_, VIDIOC_ENUM_FRAMESIZES, &size) < 0) return;
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      add_rates(format, {static_cast<int>(size.discrete.width), static_cast<int>(size.discrete.height)}, modes);
      continue;
    }
    const v4l2_frmsize_stepwise& range = size.stepwise;  // there is no second
    for (const auto& [width, height] : kUsualSizes) {
      if (lies_in(width, range.min_width, range.max_width, range.step_width) &&
          lies_in(height, range.min_height, range.max_height, range.step_height))
        add_rates(format, {static_cast<int>(width), static_cast<int>(height)}, modes);
    }
    return;
  }
}

void V4l2Node::add_rates(std::uint32_t format, cv::Size size_px, std::vector<DeviceMode>& modes) {
  DeviceMode mode{format == V4L2_PIX_FMT_Z16 ? Stream::kDepth : Stream::kColor, size_px, kDefaultFps,
                  v4l2_format_name(format)};
  for (std::uint32_t i = 0;; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = i;
    interval.pixel_format = format;
    interval.width = static_cast<std::uint32_t>(size_px.width);
    interval.height = static_cast<std::uint32_t>(size_px.height);
    const bool there = calls_.ioctl(fd_, VIDIOC_ENUM_FRAMEINTERVALS, &interval) >= 0;
    if (!there && i > 0) return;
    if (!there || interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      const double fastest = there ? rate_of(interval.stepwise.min) : kDefaultFps;
      mode.fps = std::min(kDefaultFps, fastest);
      modes.push_back(mode);
      return;
    }
    mode.fps = rate_of(interval.discrete);
    modes.push_back(mode);
  }
}

void V4l2Node::start(const DeviceMode& mode) {
  mode_ = mode;
  set_mode(mode);
  map_buffers();
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  call(VIDIOC_STREAMON, &type, "it does not start to capture");
  streaming_ = true;
}

void V4l2Node::set_mode(const DeviceMode& mode) {
  auto format = capture<v4l2_format>();
  const std::uint32_t fourcc = fourcc_of(mode.format);
  format.fmt.pix.width = static_cast<std::uint32_t>(mode.size_px.width);
  format.fmt.pix.height = static_cast<std::uint32_t>(mode.size_px.height);
  format.fmt.pix.pixelformat = fourcc;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  call(VIDIOC_S_FMT, &format, "it does not take the mode");
  const v4l2_pix_format& set = format.fmt.pix;
  if (set.pixelformat != fourcc ||
      cv::Size(static_cast<int>(set.width), static_cast<int>(set.height)) != mode.size_px) {
    throw DeviceError(DeviceProblem::kUnsupportedMode,
                      fmt::format("v4l2:{} gives {} x {} px of {} when asked for {} x {} px of {}; it has: {}", path_,
                                  set.width, set.height, v4l2_format_name(set.pixelformat), mode.size_px.width,
                                  mode.size_px.height, mode.format, list_modes(modes(), mode.stream)));
  }
  row_bytes_ = static_cast<std::size_t>(set.width) * pixel_bytes(fourcc);
  step_bytes_ = row_bytes_ == 0 ? 0 : std::max<std::size_t>(row_bytes_, set.bytesperline);
  auto rate = capture<v4l2_streamparm>();
  rate.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(mode.fps * 1000))};
  calls_.ioctl(fd_, VIDIOC_S_PARM, &rate);  // a camera with one rate does not know it
}

void V4l2Node::map_buffers() {
  auto request = capture<v4l2_requestbuffers>();
  request.count = kBuffers;
  request.memory = V4L2_MEMORY_MMAP;
  call(VIDIOC_REQBUFS, &request, "it gives no buffers");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = buffer_request(i);
    call(VIDIOC_QUERYBUF, &buffer, "it gives no buffers");
    std::uint8_t* const data = calls_.map(fd_, buffer.length, buffer.m.offset);
    if (data == nullptr) throw error_of(ENOMEM, "its buffers cannot be mapped");
    buffers_.push_back({data, buffer.length});
    call(VIDIOC_QBUF, &buffer, "it does not take its buffers");
  }
}

std::optional<DeviceImage> V4l2Node::take() {
  v4l2_buffer buffer = buffer_request(0);
  const int result = calls_.ioctl(fd_, VIDIOC_DQBUF, &buffer);
  if (result == -EAGAIN || result == -EIO) return std::nullopt;  // none, or lost on its way
  if (result < 0) throw error_of(-result, "it gives no image");
  std::optional<DeviceImage> image;
  if (buffer.index < buffers_.size() && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0) {
    const std::int64_t stamp_ns =
        std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 + std::int64_t{buffer.timestamp.tv_usec} * 1000;
    image = DeviceImage{mode_.stream, stamp_ns, pixels_of(buffers_[buffer.index], buffer.bytesused)};
  }
  call(VIDIOC_QBUF, &buffer, "it does not take its buffers");
  return image;
}

std::vector<std::uint8_t> V4l2Node::pixels_of(const Buffer& buffer, std::size_t bytes) const {
  const std::size_t used = std::min(bytes, buffer.bytes);
  if (step_bytes_ == row_bytes_) return {buffer.data, buffer.data + used};
  std::vector<std::uint8_t> pixels;
  const std::size_t rows = std::min(static_cast<std::size_t>(mode_.size_px.height), used / step_bytes_);
  pixels.reserve(rows * row_bytes_);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint8_t* const begin = buffer.data + row * step_bytes_;
    pixels.insert(pixels.end(), begin, begin + row_bytes_);
  }
  return pixels;
}

}  // namespace rtd::camera
