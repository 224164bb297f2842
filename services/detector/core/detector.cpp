// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/detector/core/detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

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
  cv::setNumThreads(config_.threads);
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
    family_ = &family;
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
  return decoder_(*outputs_, image, config_.decode);
}

namespace {

cv::Mat to_bgr(const cv::Mat& image) {
  cv::Mat bgr = image;
  switch (image.type()) {
    case CV_8UC3:
      break;
    case CV_8UC1:
      cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
      break;
    case CV_8UC4:
      cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
      break;
    default:
      throw std::invalid_argument("detector: image type " + cv::typeToString(image.type()) +
                                  " is not 8-bit BGR, BGRA or grey");
  }
  return bgr;
}

}  // namespace

std::vector<vision::Detection> Detector::detect(const cv::Mat& color_bgr) {
  if (color_bgr.empty()) return {};
  return std::move(detect_batch({&color_bgr, 1}).front());
}

std::vector<std::vector<vision::Detection>> Detector::detect_batch(std::span<const cv::Mat> images) {
  if (images.size() > 1 && !free_batch()) {
    throw std::invalid_argument(
        "detector model '" + config().model_path +
        "' takes one image at a time: `yolov5_to_onnx.py --free-batch OLD.onnx NEW.onnx` frees it");
  }
  const InputSize input = input_size();
  batch_.create(std::vector<int>{static_cast<int>(images.size()), 3, input.height_px, input.width_px}, CV_32F);
  std::vector<Letterbox> letterboxes;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].empty()) throw std::invalid_argument("detector: an image of the batch is empty");
    letterboxes.push_back(fit_letterbox(images[i].size(), input));
    cv::Mat blob(std::vector<int>{1, 3, input.height_px, input.width_px}, CV_32F, batch_.ptr(static_cast<int>(i)));
    fill_blob(to_bgr(images[i]), letterboxes.back(), input, pixels(), blob);
  }
  std::vector<std::vector<vision::Detection>> found;
  if (images.empty()) return found;
  infer(batch_);
  for (std::size_t i = 0; i < images.size(); ++i)
    found.push_back(boxes_of(static_cast<int>(i), letterboxes[i], images[i].size()));
  return found;
}

std::vector<vision::Detection> Detector::boxes_of(int image, const Letterbox& letterbox, cv::Size frame) const {
  std::vector<vision::Detection> detections;
  for (const Candidate& candidate : suppress_non_maxima(candidates(image), config().decode)) {
    const cv::Rect2f box = box_in_frame(candidate, letterbox, frame);
    if (box.empty()) continue;
    const std::string& name = config().class_names[static_cast<std::size_t>(candidate.class_index)];
    detections.push_back({name, candidate.score, box.x, box.y, box.width, box.height});
  }
  return detections;
}

namespace {

using vision::Detection;

double distance_px(const Detection& a, const Detection& b) {
  const std::array<double, 4> sides = {a.x_px - b.x_px, a.y_px - b.y_px, a.x_px + a.width_px - b.x_px - b.width_px,
                                       a.y_px + a.height_px - b.y_px - b.height_px};
  double largest = 0;
  for (const double side : sides) largest = std::max(largest, std::abs(side));
  return largest;
}

bool same(const Detection& a, const Detection& b, const AgreementLimits& limits) {
  return a.class_name == b.class_name && std::abs(a.score - b.score) <= limits.score &&
         distance_px(a, b) <= limits.box_px;
}

/// The first clear box of `from` that `in` does not have.
const Detection* missing(const std::vector<Detection>& from, const std::vector<Detection>& in, double threshold,
                         const AgreementLimits& limits) {
  for (const Detection& wanted : from) {
    const bool clear = wanted.score > threshold + limits.score;
    const auto is_it = [&](const Detection& other) { return same(wanted, other, limits); };
    if (clear && std::ranges::none_of(in, is_it)) return &wanted;
  }
  return nullptr;
}

std::string text_of(const Detection& box) {
  return box.class_name + " " + std::to_string(box.score) + " at " + std::to_string(box.x_px) + ", " +
         std::to_string(box.y_px);
}

}  // namespace

std::string disagreement(const std::vector<Detection>& expected, const std::vector<Detection>& actual,
                         double confidence_threshold, const AgreementLimits& limits) {
  if (const Detection* const box = missing(expected, actual, confidence_threshold, limits))
    return "it does not find " + text_of(*box);
  if (const Detection* const box = missing(actual, expected, confidence_threshold, limits))
    return "it finds " + text_of(*box) + ", which is not there";
  return {};
}

void AgreementCount::add(const std::string& difference) {
  ++images;
  if (difference.empty()) ++agreeing;
  if (first_difference.empty()) first_difference = difference;
}

EngineGuard::EngineGuard(DetectorConfig config, int batch) : on_cpu_(config) {
  static_cast<void>(parse_engine(config.engine));
  on_cpu_.engine = "cpu";
  guarded([&] { detector_ = std::make_unique<Detector>(std::move(config)); });
  if (batch > 1) try_batches(batch);
}

void EngineGuard::guarded(const std::function<void()>& use) {
  try {
    use();
  } catch (const EngineError& error) {
    fallback_ = error.what();
    detector_ = std::make_unique<Detector>(on_cpu_);
  }
}

/// The largest first, which finds out what the memory of the device holds.
void EngineGuard::try_batches(int most) {
  const InputSize input = detector_->input_size();
  const cv::Mat grey(input.height_px, input.width_px, CV_8UC3, cv::Scalar::all(114));
  const std::vector<cv::Mat> images(static_cast<std::size_t>(most), grey);
  try {
    for (std::size_t size = images.size(); size > 1; size = detector_->device() == kCpuDevice ? 1 : size - 1)
      guarded([&] { detector_->detect_batch(std::span(images).first(size)); });
  } catch (const std::invalid_argument& error) {
    no_batch_ = error.what();
  }
}

std::vector<std::vector<vision::Detection>> EngineGuard::detect_batch(std::span<const cv::Mat> images) {
  if (no_batch_.empty()) return detector_->detect_batch(images);
  std::vector<std::vector<vision::Detection>> found;
  for (const cv::Mat& image : images) found.push_back(detector_->detect(image));
  return found;
}

std::string EngineGuard::device() const {
  std::string text = detector_->device();
  if (!no_batch_.empty()) text += ", one image at a time";
  if (!fallback_.empty()) text += " in place of the engine asked for: " + fallback_;
  return text;
}

}  // namespace rtd::detector
