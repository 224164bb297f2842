// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/camera/devices/v4l2_device.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <map>
#include <utility>

#include "services/camera/core/live/pixel_format.hpp"
#include "services/camera/devices/v4l2_node.hpp"

namespace rtd::camera {
namespace {

bool has_stream(const std::vector<DeviceMode>& modes, Stream stream) {
  return std::ranges::any_of(modes, [=](const DeviceMode& mode) { return mode.stream == stream; });
}

class V4l2Device final : public LiveDevice {
 public:
  V4l2Device(const std::string& nodes, std::unique_ptr<KernelCalls> calls)
      : nodes_(nodes), comma_(nodes.find(',')), calls_(std::move(calls)), color_(*calls_, nodes.substr(0, comma_)) {}

  std::string name() const override { return "v4l2:" + nodes_; }
  void open() override;
  std::vector<DeviceMode> modes() override;
  DeviceSetup start(const ModeRequest& request) override;
  std::optional<DeviceImage> read(std::chrono::milliseconds timeout) override;
  void close() noexcept override {
    if (depth_) depth_->close();
    color_.close();
  }

 private:
  std::string depth_path();

  const std::string nodes_;
  const std::size_t comma_;
  const std::unique_ptr<KernelCalls> calls_;
  V4l2Node color_;
  std::unique_ptr<V4l2Node> depth_;
};

void V4l2Device::open() {
  color_.open();
  depth_ = std::make_unique<V4l2Node>(*calls_, depth_path());
  depth_->open();
}

/// The node named, else the one with depth on the same plug.
std::string V4l2Device::depth_path() {
  if (comma_ != std::string::npos) return nodes_.substr(comma_ + 1);
  for (const std::string& path : calls_->video_nodes()) {
    if (path == color_.path()) continue;
    V4l2Node node(*calls_, path);
    try {
      node.open();
    } catch (const DeviceError&) {
      continue;  // of another camera, or without images
    }
    if (node.bus() == color_.bus() && has_stream(node.modes(), Stream::kDepth)) return path;
  }
  throw DeviceError(DeviceProblem::kUnsupportedMode,
                    fmt::format("{} ({}) has no node with Z16 depth images beside it: name it, v4l2:{},/dev/videoN "
                                "(`rtd doctor` lists cameras)",
                                name(), color_.card(), nodes_));
}

std::vector<DeviceMode> V4l2Device::modes() {
  std::vector<DeviceMode> modes = color_.modes();
  std::erase_if(modes, [](const DeviceMode& mode) { return mode.stream != Stream::kColor; });
  for (const DeviceMode& mode : depth_->modes()) {
    if (mode.stream == Stream::kDepth) modes.push_back(mode);
  }
  return modes;
}

DeviceSetup V4l2Device::start(const ModeRequest& request) {
  const std::vector<DeviceMode> all = modes();
  DeviceSetup setup;
  setup.color = choose_mode(all, Stream::kColor, request, name());
  setup.depth = choose_mode(all, Stream::kDepth,
                            {setup.color.size_px.width, setup.color.size_px.height, setup.color.fps}, name());
  color_.start(setup.color);
  depth_->start(setup.depth);
  return setup;
}

std::optional<DeviceImage> V4l2Device::read(std::chrono::milliseconds timeout) {
  const int ready = calls_->wait_for_frame({color_.fd(), depth_->fd()}, timeout);
  if (ready == -ETIMEDOUT) return std::nullopt;
  if (ready < 0) throw DeviceError(DeviceProblem::kAbsent, name() + " was unplugged");
  return ready == 0 ? color_.take() : depth_->take();
}

/// The nodes of one camera. Stereo cameras have infrared nodes too: the colour node has the best format.
struct Plug {
  std::string card, color, depth;
  int color_preference = std::numeric_limits<int>::max();
  std::vector<DeviceMode> modes;

  void add(V4l2Node& node) {
    card = node.card();
    for (const DeviceMode& mode : node.modes()) {
      modes.push_back(mode);
      if (mode.stream == Stream::kDepth) {
        depth = node.path();
      } else if (preference(mode.format) < color_preference) {
        color_preference = preference(mode.format);
        color = node.path();
      }
    }
  }
  FoundCamera camera() const {
    FoundCamera found{"v4l2:" + color, card, modes, {}};
    if (!depth.empty()) found.uri += ',' + depth;
    if (depth.empty()) found.problem = "it gives no depth (Z16): choose a depth node of another camera";
    if (color.empty()) found.problem = "it gives no colour: choose a colour node of another camera";
    return found;
  }
};

}  // namespace

std::unique_ptr<LiveDevice> make_v4l2_device(const std::string& nodes, std::unique_ptr<KernelCalls> calls) {
  return std::make_unique<V4l2Device>(nodes, std::move(calls));
}

std::vector<FoundCamera> find_v4l2_cameras(KernelCalls& calls) {
  std::map<std::string, Plug> plugs;
  std::vector<FoundCamera> cameras;
  for (const std::string& path : calls.video_nodes()) {
    V4l2Node node(calls, path);
    try {
      node.open();
      plugs[node.bus()].add(node);
    } catch (const DeviceError& error) {
      if (error.problem() == DeviceProblem::kNoPermission || error.problem() == DeviceProblem::kBusy)
        cameras.push_back({"v4l2:" + path, path, {}, error.what()});
    }
  }
  for (const auto& [where, plug] : plugs) {
    if (!plug.modes.empty()) cameras.push_back(plug.camera());
  }
  return cameras;
}

}  // namespace rtd::camera
