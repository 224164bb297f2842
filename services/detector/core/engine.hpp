// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

/// What computes a network. Knows neither DDS nor classes, boxes or anchors.
namespace rtd::detector {

/// An engine or its device is not there; what() says why and what would help.
class EngineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A batch does not fit into the memory of the device; a smaller one may.
class OutOfDeviceMemory : public EngineError {
 public:
  using EngineError::EngineError;
};

/// Which engine is asked for.
struct EngineChoice {
  enum class Kind {
    kAuto,  ///< ONNX Runtime where its library is known and works, else as kCpu
    kCpu,   ///< OpenCV DNN
    kOnnxRuntime,
  };
  Kind kind = Kind::kCpu;
  std::string device;   ///< ONNX Runtime's: "cpu", "cuda", "cuda:1"
  std::string library;  ///< ONNX Runtime's; auto: empty without one
};

/// "auto", "cpu", "onnxruntime:LIBRARY" or "onnxruntime:LIBRARY@DEVICE"
/// (common/msg/engine_names.hpp). Throws EngineError naming these.
EngineChoice parse_engine(const std::string& text);

/// The engine for tables: without the path of a library, "onnxruntime@cuda". Throws as parse_engine().
std::string engine_label(const std::string& text);

/// A network as an engine takes it.
struct EngineModel {
  std::span<const std::uint8_t> onnx;
  int threads = 1;  ///< of the CPU
};

/// One output for all images: a tensor of floats, row-major, whose first dimension is the image.
struct RawOutput {
  const float* values = nullptr;
  std::vector<int> shape;  ///< empty: the output is not such a tensor

  int images() const { return shape.empty() ? 0 : shape.front(); }
  /// The numbers of one image, 0 to images() - 1.
  std::span<const float> of(int image) const;
};

/// The device() of the engine cpu.
inline constexpr const char* kCpuDevice = "CPU (OpenCV DNN)";

/// A loaded network. Not thread-safe.
class Engine {
 public:
  virtual ~Engine() = default;
  /// "CPU (OpenCV DNN)", "cuda:0 (ONNX Runtime 1.18.0)": for people.
  virtual const std::string& device() const = 0;
  /// Outputs of the network.
  virtual std::size_t outputs() const = 0;
  /// Runs the network on a blob (CV_32F, N x 3 x H x W). The order of the outputs is the engine's own, but always the
  /// same. Valid until the next call. Throws cv::Exception for a network that cannot be run.
  virtual const std::vector<RawOutput>& infer(const cv::Mat& blob) = 0;
};

/// Loads a network. Throws EngineError when the engine or its device is not there or the engine lacks an operator,
/// cv::Exception for a network that is not understood. A batch that is too large for the memory of
/// the device is computed in parts; device() then says so.
std::unique_ptr<Engine> make_engine(const EngineChoice& choice, const EngineModel& model);

/// The engine with its batches halved as often as its device needs it (OutOfDeviceMemory).
std::unique_ptr<Engine> halve_when_full(std::unique_ptr<Engine> engine);

/// Whether this program was built with ONNX Runtime's C API.
bool knows_onnxruntime();

/// Loads `library`, a libonnxruntime.so, the first time that it is asked for. `device`: "cpu", "cuda" or "cuda:1".
/// Throws EngineError: this program was built without the C API, the library cannot be loaded or is too old, its device
/// is not there, or it does not take the network.
std::unique_ptr<Engine> make_onnxruntime_engine(const EngineModel& model, const std::string& library,
                                                const std::string& device);

}  // namespace rtd::detector
