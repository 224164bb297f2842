// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <ATen/detail/CUDAHooksInterface.h>
#include <c10/core/InferenceMode.h>
#include <torch/csrc/api/include/torch/version.h>

#include <charconv>
#include <opencv2/core.hpp>
#include <utility>

#include "services/detector/core/torch/graph_runner.hpp"
#include "services/detector/core/torch/torch_module.hpp"

namespace rtd::detector {
namespace {

/// "cuda:1/fp16", taken apart.
struct Target {
  at::Device device;
  bool half = false;
};

Target parse_target(const std::string& text) {
  constexpr std::string_view kHalf = "/fp16";
  const bool half = text.ends_with(kHalf);
  const std::string name = half ? text.substr(0, text.size() - kHalf.size()) : text;
  try {
    const at::Device device(name.empty() ? "cpu" : name);
    if (device.is_cpu() || device.is_cuda()) return {device, half};
  } catch (const c10::Error&) {
  }
  throw EngineError("'" + text +
                    "' is not a device of the torch engine: use cpu, cuda or cuda:N, with /fp16 in half "
                    "precision");
}

void require_device(const Target& target) {
  if (target.device.is_cpu() && !target.half) return;
  if (target.device.is_cpu()) throw EngineError("half precision needs a GPU: torch:cuda/fp16");
  const auto count = at::hasCUDA() ? static_cast<int>(at::detail::getCUDAHooks().getNumGPUs()) : 0;
  if (!at::hasCUDA())
    throw EngineError("this libtorch (" TORCH_VERSION
                      ") is built without CUDA: build with a libtorch of the GPU's vendor "
                      "(docs/gpu-box.md)");
  if (target.device.has_index() ? target.device.index() >= count : count == 0)
    throw EngineError("libtorch finds " + std::to_string(count) + " CUDA devices, not " + target.device.str() +
                      ": `nvidia-smi` lists them");
}

class TorchEngine final : public Engine {
 public:
  TorchEngine(const OnnxGraph& graph, const Target& target)
      : target_(target),
        options_(at::TensorOptions().device(target.device).dtype(target.half ? at::kHalf : at::kFloat)),
        runner_(graph, options_),
        outputs_(graph.outputs.size()),
        device_(target.device.str() + (target.half ? " in half precision" : "") + " (libtorch " TORCH_VERSION ")") {}

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return outputs_; }

  const std::vector<RawHead>& infer(const cv::Mat& blob) override {
    const c10::InferenceMode no_gradients;
    std::vector<std::int64_t> shape(blob.size.p, blob.size.p + blob.dims);
    const at::Tensor input = at::from_blob(blob.data, shape, at::kFloat);
    results_.clear();
    heads_.clear();
    try {
      for (const at::Tensor& output : runner_.run(input.to(options_).contiguous(at::MemoryFormat::ChannelsLast)))
        results_.push_back(output.to(at::kCPU, at::kFloat).contiguous());
    } catch (const c10::OutOfMemoryError& error) {
      throw OutOfDeviceMemory(error.what_without_backtrace());
    } catch (const c10::Error& error) {
      throw EngineError(std::string("libtorch cannot compute this network: ") + error.what_without_backtrace());
    }
    for (const at::Tensor& result : results_) heads_.push_back(head_of(result));
    return heads_;
  }

 private:
  static RawHead head_of(const at::Tensor& result) {
    if (result.dim() != 4) return {};
    const auto side = [&](int axis) { return static_cast<int>(result.size(axis)); };
    return {result.data_ptr<float>(), side(0), side(1), side(2), side(3)};
  }

  const Target target_;
  const at::TensorOptions options_;
  const GraphRunner runner_;
  const std::size_t outputs_;
  const std::string device_;
  std::vector<at::Tensor> results_;
  std::vector<RawHead> heads_;
};

std::unique_ptr<Engine> create(const OnnxGraph& graph, const std::string& device, int threads) {
  const c10::InferenceMode no_gradients;
  const Target target = parse_target(device);
  require_device(target);
  at::set_num_threads(std::max(1, threads));
  try {
    return std::make_unique<TorchEngine>(graph, target);
  } catch (const c10::Error& error) {
    throw EngineError(std::string("libtorch cannot use ") + target.device.str() + ": " +
                      error.what_without_backtrace());
  }
}

std::vector<std::string> devices() {
  std::vector<std::string> names;
  const auto gpus = at::hasCUDA() ? static_cast<int>(at::detail::getCUDAHooks().getNumGPUs()) : 0;
  for (int i = 0; i < gpus; ++i) names.push_back("cuda:" + std::to_string(i));
  names.emplace_back("cpu");
  return names;
}

}  // namespace
}  // namespace rtd::detector

extern "C" __attribute__((visibility("default"))) const rtd::detector::torch_module::Module* rtd_torch_module() {
  static const rtd::detector::torch_module::Module kModule{rtd::detector::torch_module::kVersion, TORCH_VERSION,
                                                           rtd::detector::devices, rtd::detector::create};
  return &kModule;
}
