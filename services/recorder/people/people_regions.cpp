// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/recorder/people/people_regions.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "common/msg/stamps.hpp"
#include "common/vision/detection.hpp"

namespace rtd::recorder {
namespace {

/// A box grown on each side by a share of its size: hands and hair stick out.
cv::Rect2d grown(const msg::BoundingBox2D& box) {
  constexpr double kGrowth = 0.15;
  const double width_px = (1 + 2 * kGrowth) * box.size_x, height_px = (1 + 2 * kGrowth) * box.size_y;
  return {box.center.position.x - width_px / 2, box.center.position.y - height_px / 2, width_px, height_px};
}

bool is_person(const msg::Detection2D& detection) {
  return std::ranges::any_of(detection.results,
                             [](const auto& result) { return result.hypothesis.class_id == "person"; });
}

cv::Size cells_of(cv::Size image_px) {
  const auto along = [](int px) { return (px + vision::kMaskStepPx - 1) / vision::kMaskStepPx; };
  return {along(image_px.width), along(image_px.height)};
}

/// A quarter of a person's shorter side: a face that fills the box has four squares along a side, one of a person seen
/// from head to foot has one or two.
int block_of(const cv::Rect2d& person_px, cv::Size image_px) {
  constexpr double kSquares = 4, kMostSquares = 40;
  const double side_px = std::min({person_px.width, person_px.height, static_cast<double>(image_px.height)});
  return static_cast<int>(std::lround(std::max(side_px / kSquares, image_px.width / kMostSquares)));
}

void draw(const std::vector<bool>& cells, cv::Size size, cv::Mat& mask) {
  cv::Mat small(size, CV_8UC1);
  std::copy(cells.begin(), cells.end(), small.begin<std::uint8_t>());
  cv::Mat large;
  cv::resize(255 * small, large, size * vision::kMaskStepPx, 0, 0, cv::INTER_NEAREST);
  mask |= large(cv::Rect({}, mask.size()));
}

/// The cells that are a person's, and the smallest box around them.
cv::Rect2d around(const std::vector<bool>& cells, cv::Size size) {
  cv::Rect box;
  for (int i = 0; i < size.area(); ++i)
    if (cells[static_cast<std::size_t>(i)]) box |= cv::Rect(i % size.width, i / size.width, 1, 1);
  return {cv::Point2d(box.tl() * vision::kMaskStepPx), cv::Size2d(box.size() * vision::kMaskStepPx)};
}

}  // namespace

PeopleRegions::Batch& PeopleRegions::batch_of(std::int64_t stamp_ns) {
  const auto [batch, is_new] = batches_.try_emplace(stamp_ns);
  if (!is_new) return batch->second;
  order_.push_back(stamp_ns);
  if (order_.size() > most_) {
    batches_.erase(order_.front());
    order_.pop_front();
  }
  return batch->second;
}

void PeopleRegions::add(const msg::Detection2DArray& message) {
  const std::int64_t stamp_ns = msg::to_ns(message.header.stamp);
  Batch& batch = batch_of(stamp_ns);
  batch.people_px.clear();
  for (const msg::Detection2D& detection : message.detections)
    if (is_person(detection)) batch.people_px.push_back(grown(detection.bbox));
  batch.has_boxes = true;
  newest_ns_ = stamp_ns;
  frame_id_ = message.header.frame_id;
}

void PeopleRegions::add_masks(const msg::Image& labels) {
  const std::size_t cells = std::size_t{labels.width} * labels.height;
  if (labels.encoding != "mono8" || labels.step != labels.width || labels.data.size() != cells) return;
  Batch& batch = batch_of(msg::to_ns(labels.header.stamp));
  batch.cells_size = {static_cast<int>(labels.width), static_cast<int>(labels.height)};
  batch.cells.clear();
  if (std::ranges::any_of(labels.data, [](std::uint8_t label) { return label != 0; }))
    std::ranges::transform(labels.data, std::back_inserter(batch.cells), [](std::uint8_t label) { return label != 0; });
}

bool PeopleRegions::settled(std::int64_t stamp_ns) const {
  return newest_ns_ && msg::minus_ns(*newest_ns_, stamp_ns) >= kWithinNs;
}

bool PeopleRegions::known(std::int64_t stamp_ns) const {
  const auto has_boxes = [](const auto& entry) { return entry.second.has_boxes; };
  const auto same = batches_.find(stamp_ns);
  if (same != batches_.end() && same->second.has_boxes) return true;
  const auto first = batches_.lower_bound(msg::minus_ns(stamp_ns, kWithinNs)), middle = batches_.lower_bound(stamp_ns),
             last = batches_.upper_bound(msg::minus_ns(stamp_ns, -kWithinNs));
  return std::any_of(first, middle, has_boxes) && std::any_of(middle, last, has_boxes);
}

std::optional<People> PeopleRegions::at(std::int64_t stamp_ns, cv::Size image_px) const {
  if (!known(stamp_ns)) return std::nullopt;
  People people;
  cv::Mat mask(image_px, CV_8UC1, cv::Scalar(0));
  const auto last = batches_.upper_bound(msg::minus_ns(stamp_ns, -kWithinNs));
  for (auto at = batches_.lower_bound(msg::minus_ns(stamp_ns, kWithinNs)); at != last; ++at) {
    const Batch& batch = at->second;
    for (const cv::Rect2d& person : batch.people_px) {
      const cv::Rect2d seen = person & cv::Rect2d({}, cv::Size2d(image_px));
      mask(cv::Rect(cv::Point(seen.tl()), cv::Point(std::lround(seen.br().x), std::lround(seen.br().y)))) = 255;
      people.block_px = std::max(people.block_px, block_of(person, image_px));
    }
    if (batch.cells.empty() || cells_of(image_px) != batch.cells_size) continue;
    draw(batch.cells, batch.cells_size, mask);
    people.block_px = std::max(people.block_px, block_of(around(batch.cells, batch.cells_size), image_px));
  }
  if (people.block_px == 0) return people;
  constexpr int kGrownShare = 100;  // of the width, on each side
  const int side = 2 * (image_px.width / kGrownShare) + 1;
  cv::dilate(mask, people.mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return people;
}

bool PeopleRegions::concern(const std::string& frame_id, cv::Size image_px) const {
  return !frame_id.empty() && frame_id == frame_id_ && image_px == image_px_;
}

}  // namespace rtd::recorder
