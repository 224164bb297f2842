// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/detector/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "common/io/folder_walk.hpp"
#include "common/io/input_file.hpp"
#include "common/service/command_line.hpp"
#include "common/service/config.hpp"
#include "common/vision/image_codecs.hpp"
#include "common/vision/motion_levels.hpp"
#include "services/evaluation/core/detection/labels.hpp"

namespace rtd::eval {
namespace fs = std::filesystem;
namespace {

constexpr double kLeastScore = 0.001;  // the whole curve counts
constexpr std::size_t kTimedImages = 40;

bool is_image(const fs::path& path) {
  static const std::vector<std::string> kEndings = {".jpg", ".jpeg", ".png"};
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::find(kEndings, ending) != kEndings.end();
}

void require_folder(const std::string& folder, const std::string& option) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw service::ConfigError(option + " " + folder + ": there is no such folder");
  }
}

/// Every `step`-th image of a folder, by name.
std::vector<fs::path> images_in(const std::string& folder, int step) {
  require_folder(folder, "--images");
  std::vector<fs::path> all = io::FolderWalk().paths(folder), taken;
  std::erase_if(all, [](const fs::path& file) { return !is_image(file); });
  if (all.empty()) throw service::ConfigError("--images " + folder + ": has no images (jpg, jpeg, png)");
  for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(step)) taken.push_back(all[i]);
  return taken;
}

/// The file in `folder` that has the same name as `image` and one of the `endings`; empty when there is none.
fs::path partner_of(const fs::path& image, const std::string& folder, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings) {
    const fs::path candidate = fs::path(folder) / image.stem().concat(ending);
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return {};
}

std::string detect_format(const std::string& folder) {
  std::size_t yolo = 0, voc = 0;
  for (const fs::path& file : io::FolderWalk().paths(folder)) {
    const fs::path name = file.filename();
    if (name.extension() == ".txt" && name != "classes.txt") ++yolo;
    if (name.extension() == ".xml") ++voc;
  }
  if (yolo > 0 && voc > 0) {
    throw service::ConfigError("--labels " + folder + ": has " + std::to_string(yolo) + " .txt and " +
                               std::to_string(voc) + " .xml files; add --label-format yolo or voc");
  }
  if (yolo + voc == 0)
    throw service::ConfigError("--labels " + folder + ": has neither .txt (YOLO) nor .xml (VOC) files");
  return yolo > 0 ? "yolo" : "voc";
}

/// A folder of label files named like the images.
class LabelFolder {
 public:
  /// `format`: yolo (.txt), voc (.xml) or auto (the format in the folder). Throws service::ConfigError when the folder
  /// is missing, or when auto finds both formats or none.
  LabelFolder(const std::string& folder, const std::string& format) : folder_(folder), format_(format) {
    require_folder(folder, "--labels");
    if (format == "auto") format_ = detect_format(folder);
  }

  const std::string& format() const { return format_; }
  /// Whether the image has a label file; without one it has no objects.
  bool has(const fs::path& image) const { return !file_of(image).empty(); }
  ImageLabels read(const fs::path& image, ImageSize size, const std::vector<std::string>& class_names) const {
    const fs::path path = file_of(image);
    if (path.empty()) return {};
    const LabelFile text{path.filename().string(), io::try_read_file(path, io::kLabels).value_or("")};
    return format_ == "yolo" ? parse_yolo_labels(text, size, class_names) : parse_voc_labels(text, size);
  }

 private:
  fs::path file_of(const fs::path& image) const {
    return partner_of(image, folder_, {format_ == "yolo" ? ".txt" : ".xml"});
  }

  std::string folder_, format_;
};

std::string level_of(const std::string& class_name) {
  static const vision::MotionLevels levels;
  const auto level = levels.find(class_name);
  if (!level) return {};
  return *level == vision::MotionLevel::kHigh ? "high" : *level == vision::MotionLevel::kMedium ? "medium" : "low";
}

/// The position of the same model on the CPU; its own when there is none.
std::size_t reference_of(const std::vector<ModelUnderTest>& models, std::size_t index) {
  for (std::size_t i = 0; i < models.size(); ++i)
    if (models[i].engine() == "cpu" && models[i].path() == models[index].path()) return i;
  return index;
}

/// How far a model on another engine finds the boxes of the same model on the CPU.
std::optional<detector::AgreementCount> compare_engines(const std::vector<ModelUnderTest>& models,
                                                        const std::vector<std::vector<EvaluatedImage>>& evaluated,
                                                        std::size_t index) {
  const std::size_t reference = reference_of(models, index);
  if (reference == index) return std::nullopt;
  detector::AgreementCount count;
  for (std::size_t i = 0; i < evaluated[index].size(); ++i) {
    count.add(detector::disagreement(evaluated[reference][i].detections, evaluated[index][i].detections,
                                     detector::DecodeConfig{}.confidence_threshold));
  }
  return count;
}

/// Runs every model on one image.
void evaluate_image(const cv::Mat& image, const fs::path& path, const LabelFolder& labels,
                    std::vector<ModelUnderTest>& models, std::vector<std::vector<EvaluatedImage>>& evaluated,
                    InputReport& input) {
  if (!labels.has(path)) ++input.without_partner;
  for (std::size_t m = 0; m < models.size(); ++m) {
    ImageLabels truth = labels.read(path, {image.cols, image.rows}, models[m].class_names());
    if (m == 0) input.problems.insert(input.problems.end(), truth.problems.begin(), truth.problems.end());
    evaluated[m].push_back({std::move(truth.boxes), models[m].detect(image)});
    if (input.images < kTimedImages) models[m].take_time(image);
  }
  ++input.images;
}

void require_objects(const EvalDetectorOptions& options, const InputReport& input,
                     const std::vector<EvaluatedImage>& evaluated) {
  if (input.without_partner == input.images && input.images > 0) {
    throw service::ConfigError("--labels " + options.labels + ": no file in it has the name of an image of --images " +
                               options.images + " (photo.jpg needs photo.txt or photo.xml)");
  }
  for (const EvaluatedImage& image : evaluated)
    if (!image.truths.empty()) return;
  throw service::ConfigError("--labels " + options.labels + ": no object in it can be used" +
                             (input.problems.empty() ? "" : ", for example " + input.problems.front()));
}

constexpr int kGrey = 114;

struct MaskedImage {
  cv::Mat image, mask;
};

/// The image of a camera rolled by this angle: the content turns counter-clockwise about the centre. Pixels outside the
/// original image are grey and not marked.
MaskedImage rolled(const MaskedImage& upright, double roll_deg) {
  if (roll_deg == 0) return upright;
  const cv::Size size = upright.image.size();
  const cv::Point2f centre(0.5F * static_cast<float>(size.width - 1), 0.5F * static_cast<float>(size.height - 1));
  const cv::Mat turn = cv::getRotationMatrix2D(centre, roll_deg, 1.0);
  MaskedImage result;
  cv::warpAffine(upright.image, result.image, turn, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                 cv::Scalar::all(kGrey));
  cv::warpAffine(upright.mask, result.mask, turn, size, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(0));
  return result;
}

std::vector<double> angles_of(const RollRange& range) {
  std::vector<double> angles;
  for (int i = 0; range.from_deg + i * range.step_deg <= range.to_deg + 1e-9; ++i)
    angles.push_back(range.from_deg + i * range.step_deg);
  return angles;
}

/// The boxes of the class that the masks show.
std::vector<vision::Detection> wanted_boxes(const std::vector<vision::Detection>& found,
                                            const EvalDetectorOptions& options, double threshold) {
  std::vector<vision::Detection> boxes;
  std::ranges::copy_if(found, std::back_inserter(boxes), [&](const vision::Detection& box) {
    return box.class_name == options.class_name && box.score >= threshold;
  });
  return boxes;
}

void add_recall(const MaskedImage& image, const std::vector<vision::Detection>& found,
                const EvalDetectorOptions& options, std::map<double, MaskRecall>& by_threshold) {
  for (const double threshold : options.thresholds) {
    MaskRecall& sum = by_threshold[threshold];
    sum = measure_mask_recall(image.mask, wanted_boxes(found, options, threshold), sum);
  }
}

void add_overlap(const MaskedImage& image, const std::vector<vision::Detection>& found,
                 const EvalDetectorOptions& options, detector::PersonSegmenter& segmenter, MaskOverlap& overlap) {
  const auto boxes = wanted_boxes(found, options, *std::ranges::min_element(options.thresholds));
  const int all = segmenter.config().masks_per_frame;
  overlap = measure_mask_overlap(image.mask, boxes, segmenter.segment(image.image, boxes, all), overlap);
}

std::optional<MaskedImage> read_pair(const fs::path& path, const EvalDetectorOptions& options, InputReport& input) {
  const fs::path mask_path = partner_of(path, options.masks, {".png", ".jpg"});
  if (mask_path.empty()) {
    ++input.without_partner;
    return std::nullopt;
  }
  MaskedImage pair{vision::read_image(path, {.upright = true}).pixels,
                   vision::read_image(mask_path, {.pixels = vision::PixelsAs::kGrey, .upright = true}).pixels};
  const auto reject = [&](const std::string& problem) {
    ++input.not_decoded;
    input.problems.push_back(problem + ", left out");
    return std::nullopt;
  };
  if (pair.image.empty()) return reject(path.filename().string() + ": is not an image");
  const std::string name = mask_path.filename().string();
  if (pair.mask.empty()) return reject(name + ": is not an image");
  if (pair.mask.size() != pair.image.size())
    return reject(fmt::format("{}: is {} x {} px, its image is {} x {}", name, pair.mask.cols, pair.mask.rows,
                              pair.image.cols, pair.image.rows));
  pair.mask = options.dark_masks ? pair.mask < 128 : pair.mask >= 128;
  return pair;
}

}  // namespace

LabelledResults evaluate_labels(const EvalDetectorOptions& options, std::ostream& err) {
  const std::vector<fs::path> images = images_in(options.images, options.step);
  const LabelFolder labels(options.labels, options.label_format);
  std::vector<ModelUnderTest> models = load_models(options, kLeastScore);
  std::vector<std::vector<EvaluatedImage>> evaluated(models.size());
  LabelledResults results{{}, labels.format(), options.wanted_recall, {}};
  service::Progress progress(err, "images", images.size());
  for (const fs::path& path : images) {
    const cv::Mat image = vision::read_image(path, {.upright = true}).pixels;
    if (image.empty()) {
      ++results.input.not_decoded;
      results.input.problems.push_back(path.filename().string() + ": is not an image, left out");
    } else {
      evaluate_image(image, path, labels, models, evaluated, results.input);
    }
    progress.advance();
  }
  require_objects(options, results.input, evaluated.front());
  for (std::size_t m = 0; m < models.size(); ++m) {
    results.models.push_back(
        {models[m].facts(), evaluate_detector(evaluated[m], level_of), compare_engines(models, evaluated, m)});
  }
  return results;
}

MaskResults evaluate_masks(const EvalDetectorOptions& options, std::ostream& err) {
  const std::vector<fs::path> images = images_in(options.images, options.step);
  require_folder(options.masks, "--masks");
  std::vector<ModelUnderTest> models = load_models(options, *std::ranges::min_element(options.thresholds));
  const std::unique_ptr<detector::PersonSegmenter> segmenter = load_segmenter(options);
  const std::vector<double> angles_deg = angles_of(options.roll);
  MaskResults results;
  results.models.resize(models.size());
  service::Progress progress(err, "images", images.size());
  for (const fs::path& path : images) {
    const std::optional<MaskedImage> pair = read_pair(path, options, results.input);
    progress.advance();
    if (!pair) continue;
    ++results.input.images;
    for (const double roll_deg : angles_deg) {
      const MaskedImage seen = rolled(*pair, roll_deg);
      for (std::size_t m = 0; m < models.size(); ++m) {
        const std::vector<vision::Detection> found = models[m].detect(seen.image);
        add_recall(seen, found, options, results.models[m].as_seen[roll_deg]);
        if (segmenter) add_overlap(seen, found, options, *segmenter, results.models[m].overlap[roll_deg]);
      }
    }
  }
  if (results.input.images == 0) {
    throw service::ConfigError("--masks " + options.masks + ": no mask in it belongs to an image of --images " +
                               options.images + " (same name, same size)");
  }
  for (std::size_t m = 0; m < models.size(); ++m) results.models[m].model = models[m].facts();
  return results;
}

}  // namespace rtd::eval
