// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/simulated_detector.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "common/camera/synthetic/texture.hpp"
#include "common/service/model_locator.hpp"
#include "services/detector/core/detector.hpp"
#include "services/detector/core/detector_config.hpp"
#include "services/detector/core/person_segmenter.hpp"

namespace rtd::test_support {
namespace {

using nlohmann::json;

json to_json(const std::vector<vision::Detection>& boxes) {
  json list = json::array();
  for (const vision::Detection& d : boxes)
    list.push_back({d.class_name, d.score, d.x_px, d.y_px, d.width_px, d.height_px});
  return list;
}

/// Runs of equal labels: [columns, rows, length, label, length, label, ...].
json to_json(const vision::PersonMasks& masks) {
  json list = json::array({masks.columns, masks.rows});
  for (auto from = masks.labels.begin(); from != masks.labels.end();) {
    const auto to = std::find_if(from, masks.labels.end(), [from](std::uint8_t label) { return label != *from; });
    list.push_back(to - from);
    list.push_back(*from);
    from = to;
  }
  return list;
}

void from_json(const json& list, vision::PersonMasks& masks) {
  masks.columns = list.at(0);
  masks.rows = list.at(1);
  for (std::size_t i = 2; i + 1 < list.size(); i += 2)
    masks.labels.insert(masks.labels.end(), list[i].get<std::size_t>(), list[i + 1].get<std::uint8_t>());
}

void from_json(const json& list, std::vector<vision::Detection>& boxes) {
  for (const json& d : list) boxes.push_back({d.at(0), d.at(1), d.at(2), d.at(3), d.at(4), d.at(5)});
}

class Memory {
 public:
  explicit Memory(std::string file) : file_(std::move(file)) {
    if (!std::filesystem::exists(file_)) return;
    std::ifstream in(file_);
    answers_ = json::parse(in, nullptr, false);
    if (!answers_.is_object()) throw std::invalid_argument(file_ + " does not hold remembered detections");
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  ~Memory() {
    if (!grown_) return;
    std::ofstream(file_) << answers_.dump() << '\n';
  }

  template <class Answer>
  Answer recall(const camera::SourceFrame& frame, const std::function<Answer()>& look) {
    const std::string key = std::to_string(frame.image.seq);
    Answer answer;
    if (const auto known = answers_.find(key); known != answers_.end()) {
      from_json(*known, answer);
      return answer;
    }
    answer = look();
    answers_[key] = to_json(answer);
    grown_ = true;
    return answer;
  }

 private:
  std::string file_;
  json answers_ = json::object();
  bool grown_ = false;
};

/// Answers from a file (JSON, by frame number), and what is not in it from `look`, written there at the end: many runs
/// over one source need its network only once. The file belongs to one source and one network: this is not checked.
/// Throws std::invalid_argument for a file that is not one of its own.
Look remembered_look(Look look, const std::string& file) {
  return [memory = std::make_shared<Memory>(file), look = std::move(look)](const camera::SourceFrame& frame) {
    return memory->recall<std::vector<vision::Detection>>(frame, [&] { return look(frame); });
  };
}

/// The same for masks.
LookAtPixels remembered_pixels(LookAtPixels look, const std::string& file) {
  return [memory = std::make_shared<Memory>(file), look = std::move(look)](const auto& frame, const auto& boxes) {
    return memory->recall<vision::PersonMasks>(frame, [&] { return look(frame, boxes); });
  };
}

using camera::synthetic::SeededRandom;
using Boxes = std::vector<vision::Detection>;

constexpr float kLowestScore = 0.3F, kHighestScore = 0.95F;

SeededRandom random_of(const DetectorOptions& options, const camera::SourceFrame& frame) {
  SeededRandom seeds(options.seed * 0x9E3779B97F4A7C15ULL + frame.image.seq);
  return SeededRandom(seeds.next());
}

bool detectable(const camera::SourceObject& object, const DetectorOptions& options) {
  const auto& classes = detector::coco_class_names();
  return object.visible_px >= options.min_visible_px &&
         std::find(classes.begin(), classes.end(), object.class_name) != classes.end();
}

/// The box with every edge a little off, within the image; share: of its size, standard deviation.
vision::Detection jittered(vision::Detection box, float share, const cv::Size& image, SeededRandom& random) {
  const auto edge = [&](float at, float size, int end) {
    return std::clamp(at + share * size * random.normal(), 0.0F, static_cast<float>(end));
  };
  const float left = edge(box.x_px, box.width_px, image.width);
  const float right = edge(box.x_px + box.width_px, box.width_px, image.width);
  const float top = edge(box.y_px, box.height_px, image.height);
  const float low = edge(box.y_px + box.height_px, box.height_px, image.height);
  box.x_px = left;
  box.width_px = std::max(right - left, 1.0F);
  box.y_px = top;
  box.height_px = std::max(low - top, 1.0F);
  return box;
}

/// The object as a detector finds it.
vision::Detection find(const camera::SourceObject& object, float share, const cv::Size& image, SeededRandom& random) {
  const cv::Rect2f box = object.box_px;
  vision::Detection found = jittered({object.class_name, 0, box.x, box.y, box.width, box.height}, share, image, random);
  found.score = random.between(kLowestScore, kHighestScore);
  return found;
}

/// A generator for one object in one frame or span of time, apart from the frame's own.
SeededRandom random_of(const DetectorOptions& options, int object, std::uint64_t index) {
  SeededRandom seeds((options.seed + 0xB0) * 0x9E3779B97F4A7C15ULL + static_cast<std::uint64_t>(object) * 0x1D2B +
                     index);
  return SeededRandom(seeds.next());
}

/// Whether the object is in a burst of misses. Time is cut into cells with one burst each, at a random place; their
/// length gives the recall.
bool in_burst(const DetectorOptions& options, int object, std::int64_t stamp_ns) {
  const double bursts_share = 1 - options.recall / (1 - options.missed_share);
  if (bursts_share <= 0) return false;
  const double cell_s = (kShortestBurst_s + kLongestBurst_s) / 2 / bursts_share;
  const double cells = static_cast<double>(stamp_ns) * 1e-9 / cell_s;
  SeededRandom random = random_of(options, object, static_cast<std::uint64_t>(cells));
  const double burst_s = kShortestBurst_s + (kLongestBurst_s - kShortestBurst_s) * static_cast<double>(random.unit());
  const double begin_s = (cell_s - burst_s) * static_cast<double>(random.unit());
  const double now_s = (cells - std::floor(cells)) * cell_s;
  return now_s >= begin_s && now_s < begin_s + burst_s;
}

/// Takes a fifth to a half away at one side, at the feet as often as at the three others together.
void cut(vision::Detection& box, SeededRandom& random) {
  const float lost = random.between(0.2F, 0.5F);
  const int side = random.index(6);
  if (side == 0) box.x_px += lost * box.width_px;
  if (side <= 1) {
    box.width_px *= 1 - lost;
    return;
  }
  if (side == 2) box.y_px += lost * box.height_px;
  box.height_px *= 1 - lost;
}

Boxes see_truth(const camera::SourceFrame& frame, const DetectorOptions& options) {
  if (!frame.T_world_camera) throw std::invalid_argument("detector truth: only synthetic sources know their objects");
  SeededRandom random = random_of(options, frame);
  Boxes boxes;
  for (const camera::SourceObject& object : frame.objects) {
    const bool missed = static_cast<double>(random.unit()) < options.missed_share;
    vision::Detection box =
        find(object, static_cast<float>(options.jitter_share), frame.image.color_bgr.size(), random);
    if (missed || !detectable(object, options) || in_burst(options, object.id, frame.image.stamp_ns)) continue;
    SeededRandom cuts = random_of(options, object.id, frame.image.seq);
    if (static_cast<double>(cuts.unit()) < options.cut_share) cut(box, cuts);
    boxes.push_back(std::move(box));
  }
  return boxes;
}

Boxes lie(const camera::SourceFrame& frame, const DetectorOptions& options) {
  SeededRandom random = random_of(options, frame);
  const auto& classes = detector::coco_class_names();
  const auto width = static_cast<float>(frame.image.color_bgr.cols),
             height = static_cast<float>(frame.image.color_bgr.rows);
  Boxes boxes(static_cast<std::size_t>(random.index(options.max_lies + 1)));
  for (vision::Detection& box : boxes) {
    box.class_name = random.unit() < 0.5F
                         ? "person"
                         : classes[static_cast<std::size_t>(random.index(static_cast<int>(classes.size())))];
    box.score = random.between(kLowestScore, kHighestScore);
    box.width_px = random.between(0.03F, 0.6F) * width;
    box.height_px = random.between(0.03F, 0.9F) * height;
    box.x_px = random.between(0, width - box.width_px);
    box.y_px = random.between(0, height - box.height_px);
  }
  return boxes;
}

Look real_look(const DetectorOptions& options) {
  const service::ModelSearch model = service::find_model(options.model, service::process_environment());
  if (!model) throw std::invalid_argument(model.message);
  detector::DetectorConfig config;
  config.model_path = model.path;
  config.engine = "cpu";
  config.decode.confidence_threshold = options.confidence;
  config.decode.objectness_threshold = std::min(config.decode.objectness_threshold, options.confidence);
  return [network = std::make_shared<detector::Detector>(config)](const camera::SourceFrame& frame) {
    return network->detect(frame.image.color_bgr);
  };
}

/// The same answers, a little off.
Look jitter(Look look, const DetectorOptions& options) {
  return [look = std::move(look), options](const camera::SourceFrame& frame) {
    SeededRandom random = random_of(options, frame);
    Boxes boxes = look(frame);
    for (vision::Detection& box : boxes) {
      box =
          jittered(std::move(box), static_cast<float>(options.jitter_real_share), frame.image.color_bgr.size(), random);
    }
    return boxes;
  };
}

/// Of the boxes of people that contain a place, the one in whose middle it lies most.
std::uint8_t person_at(const Boxes& boxes, float x_px, float y_px) {
  float best = 1;
  std::uint8_t label = 0;
  for (std::size_t i = 0; i < std::min(boxes.size(), vision::kMaxMasks); ++i) {
    const vision::Detection& box = boxes[i];
    if (box.class_name != "person") continue;
    const float x = std::abs(2 * (x_px - box.x_px) / box.width_px - 1);
    const float y = std::abs(2 * (y_px - box.y_px) / box.height_px - 1);
    if (std::max(x, y) > best) continue;
    best = std::max(x, y);
    label = static_cast<std::uint8_t>(i + 1);
  }
  return label;
}

vision::PersonMasks true_pixels(const camera::SourceFrame& frame, const Boxes& boxes) {
  const cv::Mat& moving = frame.dynamic_mask;
  if (moving.empty()) throw std::invalid_argument("masks truth: the source has no masks (tum:DIR?masks=1)");
  constexpr int kStep = vision::kMaskStepPx;
  vision::PersonMasks masks{(moving.cols + kStep - 1) / kStep, (moving.rows + kStep - 1) / kStep, {}};
  for (int row = 0; row < masks.rows; ++row) {
    for (int column = 0; column < masks.columns; ++column) {
      const cv::Rect place = cv::Rect(column * kStep, row * kStep, kStep, kStep) & cv::Rect({}, moving.size());
      const bool moves = 2 * cv::countNonZero(moving(place)) >= place.area();
      const float x_px = static_cast<float>(column * kStep) + 0.5F * (kStep - 1);
      const float y_px = static_cast<float>(row * kStep) + 0.5F * (kStep - 1);
      masks.labels.push_back(moves ? person_at(boxes, x_px, y_px) : std::uint8_t{0});
    }
  }
  return masks;
}

/// Every mask is computed again: a frame then has the same ones in every run.
LookAtPixels segmented_pixels(const std::string& model_path) {
  detector::MaskConfig config;
  config.model_path = model_path;
  config.engine = "cpu";
  return [segmenter = std::shared_ptr<detector::PersonSegmenter>(), config](const auto& frame,
                                                                            const Boxes& boxes) mutable {
    if (segmenter == nullptr) segmenter = std::make_shared<detector::PersonSegmenter>(config);
    return segmenter->segment(frame.image.color_bgr, boxes, config.masks_per_frame);
  };
}

}  // namespace

LookAtPixels make_look_at_pixels(const DetectorOptions& options) {
  if (options.masks == "off") return {};
  if (options.masks == "truth") return true_pixels;
  LookAtPixels look = segmented_pixels(options.masks);
  if (options.masks_remembered_in.empty()) return look;
  return remembered_pixels(std::move(look), options.masks_remembered_in);
}

Look make_look(const DetectorOptions& options) {
  if (options.recall < kLeastRecall || options.recall > 1) {
    throw std::invalid_argument("detector: recall is " + std::to_string(options.recall) + ", allowed is [" +
                                std::to_string(kLeastRecall) + ", 1]");
  }
  const auto remember = [&options](Look look) {
    return options.remembered_in.empty() ? std::move(look) : remembered_look(std::move(look), options.remembered_in);
  };
  if (options.kind == "real") {
    Look look = remember(real_look(options));
    return options.jitter_real_share > 0 ? jitter(std::move(look), options) : look;
  }
  if (options.kind == "truth") return remember([options](const auto& frame) { return see_truth(frame, options); });
  if (options.kind == "lying") return [options](const auto& frame) { return lie(frame, options); };
  throw std::invalid_argument("unknown detector '" + options.kind + "': real, truth, lying, off");
}

}  // namespace rtd::test_support
