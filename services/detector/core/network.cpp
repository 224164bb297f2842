// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/network.hpp"

#include <optional>
#include <utility>

#include "services/detector/core/decoders/yolov5.hpp"
#include "services/detector/core/onnx_file.hpp"

namespace rtd::detector {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  ModelName{"detector model", "detector.model", path}.refuse(cause);
}

constexpr int kSideMultiple = 32;  // the largest stride

/// What would have fitted, for people.
std::string expectations(const NetworkFacts& facts) {
  std::string text;
  for (const DecoderFamily& family : decoder_families())
    text += (text.empty() ? "" : ", ") + std::string(family.title) + " " + family.expected(facts);
  return text;
}

/// ". It looks like YOLOX with 3 classes: ..." when only the number of classes does not fit.
std::string other_classes(const NetworkFacts& facts, const std::vector<RawOutput>& outputs) {
  for (const DecoderFamily& family : decoder_families()) {
    if (const std::optional<int> classes = family.classes_in(facts, outputs))
      return std::string(". It looks like ") + family.title + " with " + std::to_string(*classes) +
             " classes: name them with detector.class_names";
  }
  return {};
}

}  // namespace

const std::vector<std::string>& coco_class_names() {
  static const std::vector<std::string> names = {
      "person",         "bicycle",    "car",           "motorcycle",    "airplane",     "bus",           "train",
      "truck",          "boat",       "traffic light", "fire hydrant",  "stop sign",    "parking meter", "bench",
      "bird",           "cat",        "dog",           "horse",         "sheep",        "cow",           "elephant",
      "bear",           "zebra",      "giraffe",       "backpack",      "umbrella",     "handbag",       "tie",
      "suitcase",       "frisbee",    "skis",          "snowboard",     "sports ball",  "kite",          "baseball bat",
      "baseball glove", "skateboard", "surfboard",     "tennis racket", "bottle",       "wine glass",    "cup",
      "fork",           "knife",      "spoon",         "bowl",          "banana",       "apple",         "sandwich",
      "orange",         "broccoli",   "carrot",        "hot dog",       "pizza",        "donut",         "cake",
      "chair",          "couch",      "potted plant",  "bed",           "dining table", "toilet",        "tv",
      "laptop",         "mouse",      "remote",        "keyboard",      "cell phone",   "microwave",     "oven",
      "toaster",        "sink",       "refrigerator",  "book",          "clock",        "vase",          "scissors",
      "teddy bear",     "hair drier", "toothbrush"};
  return names;
}

Network::Network(DetectorConfig config) : config_(std::move(config)) {
  const QuietOpenCv quiet;
  try {
    load();
    infer(cv::Mat(std::vector<int>{1, 3, input_.height_px, input_.width_px}, CV_32F, cv::Scalar(0)));
    choose_decoder();
  } catch (const cv::Exception& error) {
    fail(config_.model_path, "is broken or not understood by OpenCV (" + std::string(error.err) + ")");
  }
}

void Network::load() {
  const std::vector<std::uint8_t> bytes = read_model_file({"detector model", "detector.model", config_.model_path});
  const OnnxFile file = read_onnx_file(bytes.data(), bytes.size());
  if (!file.has_graph) fail(config_.model_path, "is not an ONNX model, or is cut off");
  complete_config(file);
  free_batch_ = file.free_batch;
  input_ = file.input.value_or(InputSize{config_.input_width_px, config_.input_height_px});
  if (input_.width_px % kSideMultiple != 0 || input_.height_px % kSideMultiple != 0) {
    fail(config_.model_path, "has an input of " + std::to_string(input_.width_px) + "x" +
                                 std::to_string(input_.height_px) + " px, of which both must be multiples of " +
                                 std::to_string(kSideMultiple));
  }
  EngineChoice engine = parse_engine(config_.engine);
  if (engine.kind == EngineChoice::Kind::kAuto) engine.library = config_.onnxruntime;
  engine_ = make_engine(engine, {.onnx = bytes, .threads = config_.threads});
}

/// What is not configured comes from the file's metadata, else from the families' defaults.
void Network::complete_config(const OnnxFile& file) {
  const auto metadata = [&file](const char* key) {
    const auto found = file.metadata.find(key);
    return found == file.metadata.end() ? std::string() : found->second;
  };
  if (config_.class_names.empty()) config_.class_names = split_lines(metadata("rtd.class_names"));
  if (config_.class_names.empty()) config_.class_names = coco_class_names();
  if (config_.heads.empty()) config_.heads = parse_heads(metadata("rtd.heads"));
  if (config_.heads.empty()) config_.heads = yolov5_heads();
  wanted_decoder_ = metadata("rtd.decoder");
  const std::string classes = metadata("rtd.class_count"), named = std::to_string(config_.class_names.size());
  if (!classes.empty() && classes != named) {
    fail(config_.model_path, "has " + classes + " classes, but " + named + " are named: correct detector.class_names");
  }
}

void Network::choose_decoder() {
  const NetworkFacts facts{input_, static_cast<int>(config_.class_names.size()), config_.heads};
  bool known = wanted_decoder_.empty();
  for (const DecoderFamily& family : decoder_families()) {
    known = known || wanted_decoder_ == family.name;
    if (!wanted_decoder_.empty() && wanted_decoder_ != family.name) continue;
    decoder_ = family.make(facts, *outputs_);
    family_ = family.title;
    if (decoder_) return;
  }
  if (!known) {
    fail(config_.model_path,
         "names the decoder '" + wanted_decoder_ + "' in its metadata; there are " + decoder_names());
  }
  fail(config_.model_path, "is of no known kind: it has " + std::to_string(outputs_->size()) + " outputs of shape " +
                               shapes_text(*outputs_) + "; with " + std::to_string(facts.class_count) +
                               " classes and this input, " + expectations(facts) + " would fit" +
                               other_classes(facts, *outputs_));
}

const std::vector<RawOutput>& Network::infer(const cv::Mat& blob) {
  outputs_ = &engine_->infer(blob);
  return *outputs_;
}

std::vector<Candidate> Network::candidates(int image) const {
  return decoder_->decode(*outputs_, image, config_.decode);
}

}  // namespace rtd::detector
