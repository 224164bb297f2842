// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/engine.hpp"

#include <algorithm>
#include <cstddef>
#include <opencv2/dnn.hpp>
#include <utility>

#include "common/msg/engine_names.hpp"
#include "services/detector/core/fast_sigmoid.hpp"

namespace rtd::detector {
namespace {

using Kind = EngineChoice::Kind;

constexpr std::string_view kOnnxRuntimePrefix = "onnxruntime:";

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

/// OpenCV's DNN module on the CPU; `device` names it for people.
class OpencvEngine final : public Engine {
 public:
  OpencvEngine(const EngineModel& model, std::string device) : device_(std::move(device)) {
    const FastSigmoidScope fast_sigmoid;
    net_ = cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(model.onnx.data()), model.onnx.size());
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    names_ = net_.getUnconnectedOutLayersNames();
  }

  const std::string& device() const override { return device_; }
  std::size_t outputs() const override { return names_.size(); }
  const std::vector<RawOutput>& infer(const cv::Mat& blob) override {
    net_.setInput(blob);
    net_.forward(mats_, names_);
    tensors_.clear();
    for (const cv::Mat& mat : mats_) {
      const bool floats = mat.type() == CV_32F && mat.isContinuous();
      tensors_.push_back(floats ? RawOutput{mat.ptr<float>(), {mat.size.p, mat.size.p + mat.dims}} : RawOutput{});
    }
    return tensors_;
  }

 private:
  const std::string device_;
  cv::dnn::Net net_;
  std::vector<cv::String> names_;
  std::vector<cv::Mat> mats_;
  std::vector<RawOutput> tensors_;
};

/// ONNX Runtime where it works, else OpenCV with the cause in its name.
std::unique_ptr<Engine> make_best_engine(const std::string& onnxruntime, const EngineModel& model) {
  std::string cause;
  if (!onnxruntime.empty() && knows_onnxruntime()) {
    try {
      return halve_when_full(make_onnxruntime_engine(model, onnxruntime, "cpu"));
    } catch (const EngineError& error) {
      cause = error.what();
    }
  }
  return std::make_unique<OpencvEngine>(model, kCpuDevice + (cause.empty() ? cause : ", because " + cause));
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
    case Kind::kCpu:
      break;
  }
  return std::make_unique<OpencvEngine>(model, kCpuDevice);
}

std::unique_ptr<Engine> halve_when_full(std::unique_ptr<Engine> engine) {
  return std::make_unique<HalvingEngine>(std::move(engine));
}

}  // namespace rtd::detector
