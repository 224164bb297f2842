// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/core/ocl.hpp>
#include <optional>
#include <utility>

#include "common/msg/engine_names.hpp"
#include "services/detector/core/opencv_engine.hpp"

namespace rtd::detector {
namespace {

using Kind = EngineChoice::Kind;

constexpr std::string_view kOpenClPrefix = "opencl:", kOnnxRuntimePrefix = "onnxruntime:";

struct FoundDevice {
  std::string name;
  cv::ocl::Device device;
  bool gpu = false;
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::vector<FoundDevice> find_devices() {
  std::vector<FoundDevice> found;
  std::vector<cv::ocl::PlatformInfo> platforms;
  if (!cv::ocl::haveOpenCL()) return found;
  cv::ocl::getPlatfomsInfo(platforms);
  for (const cv::ocl::PlatformInfo& platform : platforms) {
    for (int i = 0; i < platform.deviceNumber(); ++i) {
      cv::ocl::Device device;
      platform.getDevice(device, i);
      const bool gpu = (device.type() & cv::ocl::Device::TYPE_GPU) != 0;
      found.push_back({device.name(), device, gpu});
    }
  }
  return found;
}

/// The first device whose name holds what is asked for; GPUs first.
std::optional<FoundDevice> choose_device(const std::string& wanted, bool gpu_only) {
  std::vector<FoundDevice> devices = find_devices();
  std::ranges::stable_partition(devices, &FoundDevice::gpu);
  for (const FoundDevice& device : devices) {
    const bool named = lower(device.name).find(lower(wanted)) != std::string::npos;
    if (named && (device.gpu || !gpu_only)) return device;
  }
  return std::nullopt;
}

std::string names_of(const std::vector<std::string>& devices) {
  std::string text;
  for (const std::string& device : devices) text += (text.empty() ? "" : ", ") + device;
  return text;
}

/// Compiling and tuning for a device takes minutes. OpenCV reads these before it first compiles.
void keep_kernels(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code ignored;
  std::filesystem::create_directories(folder, ignored);
  setenv("OPENCV_OCL4DNN_CONFIG_PATH", folder.c_str(), 0);
  setenv("OPENCV_OPENCL_CACHE_DIR", folder.c_str(), 0);
}

std::unique_ptr<Engine> make_opencl(const FoundDevice& found, const EngineModel& model) {
  const auto refuse = [&](const std::string& cause) {
    return EngineError("OpenCL device " + found.name + " cannot be used: " + cause);
  };
  if (!found.device.isIntel() && std::getenv(kAllowAllDevices) == nullptr)
    throw refuse(std::string("set ") + kAllowAllDevices + "=1 before the program starts");
  keep_kernels(model.kernel_cache);
  cv::ocl::OpenCLExecutionContext opencl;
  try {
    const cv::ocl::Context context = cv::ocl::Context::fromDevice(found.device);
    opencl = cv::ocl::OpenCLExecutionContext::create(context, context.device(0));
  } catch (const cv::Exception& error) {
    throw refuse(error.err);
  }
  const cv::ocl::OpenCLExecutionContextScope scope(opencl);
  if (!cv::ocl::useOpenCL()) throw refuse("OpenCV does not use it");
  return make_opencv_engine(model, found.name + " (OpenCL, OpenCV DNN)", opencl);
}

/// "/opt/lib/libonnxruntime.so@cuda:1", taken apart.
EngineChoice onnxruntime_choice(const std::string& text) {
  const std::size_t at = text.rfind('@');
  const bool has_device = at != std::string::npos && text.find('/', at) == std::string::npos;
  EngineChoice choice{Kind::kOnnxRuntime, has_device ? text.substr(at + 1) : "cpu",
                      text.substr(0, has_device ? at : text.size())};
  if (choice.library.empty())
    throw EngineError("the engine onnxruntime needs the path of its library: onnxruntime:/path/to/libonnxruntime.so");
  return choice;
}

EngineError no_opencl_device(const std::string& wanted) {
  const std::vector<std::string> there = opencl_devices();
  return EngineError("there is no OpenCL device" + (wanted.empty() ? std::string() : " '" + wanted + "'") +
                     (there.empty() ? ": install the OpenCL driver of the GPU (`clinfo` lists devices)"
                                    : "; there are: " + names_of(there)));
}

/// A GPU's driver needs the file of its kernel module. To look for OpenCL devices loads all drivers of the host: one
/// for the CPU takes 60 MB, and half of the detector's start.
bool may_have_gpu() {
  constexpr std::array kFiles{"/dev/dri", "/dev/nvidiactl", "/dev/kfd", "/dev/mali0", "/dev/kgsl-3d0", "/dev/dxg"};
  std::error_code unreadable;
  return std::ranges::any_of(kFiles, [&](const char* file) { return std::filesystem::exists(file, unreadable); });
}

/// ONNX Runtime where it works, else OpenCL on a GPU, else the CPU with the cause in its name.
std::unique_ptr<Engine> make_best_engine(const std::string& onnxruntime, const EngineModel& model) {
  std::string cause;
  if (!onnxruntime.empty() && knows_onnxruntime()) {
    try {
      return halve_when_full(make_onnxruntime_engine(model, onnxruntime, "cpu"));
    } catch (const EngineError& error) {
      cause = error.what();
    }
  }
  if (const auto gpu = may_have_gpu() ? choose_device({}, true) : std::nullopt) return make_opencl(*gpu, model);
  return make_opencv_engine(model, kCpuDevice + (cause.empty() ? cause : ", because " + cause), std::nullopt);
}

/// The images [first, first + count) of a blob.
cv::Mat part_of(const cv::Mat& blob, int first, int count) {
  std::vector<int> sizes(blob.size.p, blob.size.p + blob.dims);
  sizes[0] = count;
  return cv::Mat(sizes, blob.type(), const_cast<uchar*>(blob.ptr(first)));
}

class HalvingEngine final : public Engine {
 public:
  explicit HalvingEngine(std::unique_ptr<Engine> engine) : engine_(std::move(engine)), device_(engine_->device()) {}

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return engine_->outputs(); }

  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    while (true) {
      const int images = blob.size[0];
      try {
        return most_ == 0 || images <= most_ ? engine_->infer(blob) : infer_in_parts(blob);
      } catch (const OutOfDeviceMemory&) {
        const int tried = most_ == 0 ? images : std::min(images, most_);
        if (tried == 1) throw;
        most_ = (tried + 1) / 2;
        device_ = engine_->device() + ", at most " + std::to_string(most_) +
                  " images at once because its memory holds no more";
      }
    }
  }

 private:
  const std::vector<RawOutput>& infer_in_parts(const cv::Mat& blob) {
    values_.assign(outputs(), {});
    outputs_.assign(outputs(), {});
    for (int first = 0; first < blob.size[0]; first += most_) {
      const std::vector<RawOutput>& part = engine_->infer(part_of(blob, first, std::min(most_, blob.size[0] - first)));
      for (std::size_t i = 0; i < part.size(); ++i) append(part[i], i);
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i)
      outputs_[i].values = values_[i].empty() ? nullptr : values_[i].data();
    return outputs_;
  }

  void append(const RawOutput& output, std::size_t i) {
    if (output.values == nullptr) return;
    for (int image = 0; image < output.images(); ++image) {
      const std::span<const float> values = output.of(image);
      values_[i].insert(values_[i].end(), values.begin(), values.end());
    }
    const int before = outputs_[i].images();
    outputs_[i] = output;
    outputs_[i].shape.front() += before;
  }

  const std::unique_ptr<Engine> engine_;
  std::string device_;
  int most_ = 0;                            ///< images at a time; 0: any number
  std::vector<std::vector<float>> values_;  ///< of each output
  std::vector<RawOutput> outputs_;
};

}  // namespace

std::span<const float> RawOutput::of(int image) const {
  if (image < 0 || image >= images()) throw std::out_of_range("the network has no image " + std::to_string(image));
  std::size_t count = 1;
  for (std::size_t i = 1; i < shape.size(); ++i) count *= static_cast<std::size_t>(shape[i]);
  return {values + static_cast<std::size_t>(image) * count, count};
}

EngineChoice parse_engine(const std::string& text) {
  if (text == "auto") return {Kind::kAuto, {}};
  if (text == "cpu") return {Kind::kCpu, {}};
  if (text == "opencl") return {Kind::kOpenCl, {}};
  if (text.starts_with(kOpenClPrefix)) return {Kind::kOpenCl, text.substr(kOpenClPrefix.size())};
  if (text == "onnxruntime") return onnxruntime_choice({});
  if (text.starts_with(kOnnxRuntimePrefix)) return onnxruntime_choice(text.substr(kOnnxRuntimePrefix.size()));
  throw EngineError("'" + text + "' is not an engine: use " + msg::kEngineNames);
}

std::string engine_label(const std::string& text) {
  const EngineChoice choice = parse_engine(text);
  if (choice.kind != Kind::kOnnxRuntime) return text;
  return choice.device == "cpu" ? "onnxruntime" : "onnxruntime@" + choice.device;
}

std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineModel& model) {
  switch (choice.kind) {
    case Kind::kAuto:
      return make_best_engine(choice.library, model);
    case Kind::kOnnxRuntime:
      return halve_when_full(make_onnxruntime_engine(model, choice.library, choice.device));
    case Kind::kOpenCl:
      if (const auto device = choose_device(choice.device, false)) return make_opencl(*device, model);
      throw no_opencl_device(choice.device);
    case Kind::kCpu:
      break;
  }
  return make_opencv_engine(model, kCpuDevice, std::nullopt);
}

std::vector<std::string> opencl_devices() {
  std::vector<std::string> names;
  for (const FoundDevice& device : find_devices()) names.push_back(device.name + (device.gpu ? " (GPU)" : " (CPU)"));
  return names;
}

std::unique_ptr<Engine> halve_when_full(std::unique_ptr<Engine> engine) {
  return std::make_unique<HalvingEngine>(std::move(engine));
}

}  // namespace rtd::detector
