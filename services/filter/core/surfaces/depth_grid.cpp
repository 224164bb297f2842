// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/filter/core/surfaces/depth_grid.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "services/filter/core/surfaces/cell_masks.hpp"

namespace rtd::filter {
namespace {

constexpr double kStepFactorPerM = 0.012;  ///< the step grows by this times depth squared
constexpr int kMinClusterCells = 12;       ///< smaller clusters are ignored

constexpr float kUnmeasuredNear = std::numeric_limits<float>::max();

/// Per cell: are enough of its 3x3 neighbourhood measured?
std::vector<std::uint8_t> well_surrounded(const DepthGrid& grid) {
  std::vector<std::uint8_t> count(grid.depth_m.size());
  std::transform(grid.depth_m.begin(), grid.depth_m.end(), count.begin(),
                 [](float depth_m) { return static_cast<std::uint8_t>(depth_m > 0 ? 1 : 0); });
  cv::Mat image(grid.shape.rows, grid.shape.columns, CV_8U, count.data());
  cv::boxFilter(image, image, CV_8U, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  for (std::uint8_t& cell : count) cell = cell >= DepthGrid::kMinNeighbours ? 1 : 0;
  return count;
}

/// Spreads the range of each cell over its 3x3 neighbourhood.
void widen_ranges(DepthGrid& grid) {
  const std::vector<std::uint8_t> enough = well_surrounded(grid);
  grid.near_m = smallest_near(grid.shape, std::move(grid.near_m), 1);
  grid.far_m = largest_near(grid.shape, std::move(grid.far_m), 1);
  for (std::size_t i = 0; i < enough.size(); ++i) {
    if (enough[i] == 0) grid.near_m[i] = grid.far_m[i] = 0;
  }
}

struct DepthLimits {
  float scale_m, min_m, max_m;
};

constexpr std::size_t kBlockCells = 32, kSamplesOfCell = 4;
using SampleBlock = std::array<std::array<std::uint16_t, kBlockCells>, kSamplesOfCell>;

struct RangeBlock {
  std::array<float, kBlockCells> typical_m, near_m, far_m;
};

/// Per cell the least, the lower middle one and the largest of its samples within the limits; of fewer than two of
/// them, what an unmeasured cell has. Without branches, for vector instructions: samples beyond the limits are sorted
/// last.
RangeBlock ranges_of(const SampleBlock& samples, const DepthLimits& limits) {
  RangeBlock ranges;
  for (std::size_t i = 0; i < kBlockCells; ++i) {
    const auto value_m = [&](std::size_t k) { return static_cast<float>(samples[k][i]) * limits.scale_m; };
    const auto is_within = [&](float m) { return (m >= limits.min_m) & (m <= limits.max_m); };
    const auto or_last = [&](float m) { return is_within(m) ? m : kUnmeasuredNear; };
    const auto lesser = [](float x, float y) { return x < y ? x : y; };
    const auto greater = [](float x, float y) { return x < y ? y : x; };
    const float a = or_last(value_m(0)), b = or_last(value_m(1)), c = or_last(value_m(2)), d = or_last(value_m(3));
    const float low = lesser(a, b), high = greater(a, b), low_2 = lesser(c, d), high_2 = greater(c, d);
    const float first = lesser(low, low_2), last = greater(high, high_2);
    const float inner = greater(low, low_2), inner_2 = lesser(high, high_2);
    const float second = lesser(inner, inner_2), third = greater(inner, inner_2);
    const bool has_two = second < kUnmeasuredNear, has_three = third < kUnmeasuredNear,
               has_four = last < kUnmeasuredNear;
    ranges.near_m[i] = has_two ? first : kUnmeasuredNear;
    ranges.typical_m[i] = has_three ? second : (has_two ? first : 0.0F);
    ranges.far_m[i] = has_four ? last : (has_three ? third : (has_two ? second : 0.0F));
  }
  return ranges;
}

/// Union-find whose root is the smallest member, so that numbering does not depend on the order of joins.
class DisjointCells {
 public:
  explicit DisjointCells(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int cell) {
    while (parent_[static_cast<std::size_t>(cell)] != cell) {
      auto& parent = parent_[static_cast<std::size_t>(cell)];
      parent = parent_[static_cast<std::size_t>(parent)];
      cell = parent;
    }
    return cell;
  }
  void join(int a, int b) {
    if (parent_[static_cast<std::size_t>(a)] == parent_[static_cast<std::size_t>(b)]) return;
    a = root(a);
    b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  /// Joins a cell that is still alone with an earlier one.
  void add_to(int earlier, int cell) { parent_[static_cast<std::size_t>(cell)] = root(earlier); }

 private:
  std::vector<int> parent_;
};

void join_neighbours(const DepthGrid& grid, const ClusterConfig& config, DisjointCells& sets) {
  const auto step = static_cast<float>(config.step_m), factor = static_cast<float>(kStepFactorPerM);
  const auto are_near = [&](int a, int b) {
    const float za = grid.depth_m[static_cast<std::size_t>(a)], zb = grid.depth_m[static_cast<std::size_t>(b)];
    const float nearer = std::min(za, zb);
    return nearer > 0 && std::abs(za - zb) < step + factor * nearer * nearer;
  };
  for (int row = 0; row < grid.shape.rows; ++row) {
    for (int column = 0; column < grid.shape.columns; ++column) {
      const int cell = grid.shape.index(column, row), above = cell - grid.shape.columns;
      if (column > 0 && are_near(cell - 1, cell)) sets.add_to(cell - 1, cell);
      if (row > 0 && are_near(above, cell)) sets.join(above, cell);
    }
  }
}

}  // namespace

void DepthGridSampler::fit(const vision::RgbdImage& image) {
  if (size_ == image.depth.size() && parameters_ == image.camera.parameters()) return;
  size_ = image.depth.size();
  parameters_ = image.camera.parameters();
  const int side_px = cell_side_px(size_.width, size_.height);
  shape_ = {std::max(1, size_.width / side_px), std::max(1, size_.height / side_px), side_px};
  pixels_.clear();
  rays_.clear();
  const std::array<double, 2> offsets{0.25 * side_px - 0.5, 0.75 * side_px - 0.5};  // two by two samples, evenly spread
  for (int row = 0; row < shape_.rows; ++row) {
    for (int column = 0; column < shape_.columns; ++column) {
      const Eigen::Vector2d corner(column * side_px, row * side_px);
      for (int k = 0; k < kSamples; ++k) {
        const Eigen::Vector2d raw = image.camera.distort(corner + Eigen::Vector2d(offsets[k % 2], offsets[k / 2]));
        const long u = std::lround(raw.x()), v = std::lround(raw.y());
        const bool inside = u >= 0 && v >= 0 && u < size_.width && v < size_.height;
        pixels_.push_back(inside ? static_cast<int>(v * size_.width + u) : -1);
      }
      const Eigen::Vector2d centre = corner.array() + 0.5 * (side_px - 1);
      rays_.push_back(image.camera.unproject(centre, 1.0).cast<float>());
    }
  }
}

DepthGrid DepthGridSampler::sample(const vision::RgbdImage& image) {
  fit(image);
  const auto cells = static_cast<std::size_t>(shape_.size());
  DepthGrid grid{shape_, std::vector<float>(cells), std::vector<float>(cells), std::vector<float>(cells)};
  const cv::Mat depth = image.depth.isContinuous() ? image.depth : image.depth.clone();
  const auto* raw = depth.ptr<std::uint16_t>();
  const DepthLimits limits{static_cast<float>(image.depth_scale_m), static_cast<float>(min_depth_m_),
                           static_cast<float>(max_depth_m_)};
  static_assert(kSamples == kSamplesOfCell);
  SampleBlock samples{};
  for (std::size_t begin = 0; begin < cells; begin += kBlockCells) {
    const std::size_t count = std::min(kBlockCells, cells - begin);
    const int* pixel = &pixels_[begin * kSamples];
    for (std::size_t cell = 0; cell < count; ++cell) {
      for (int k = 0; k < kSamples; ++k, ++pixel)
        samples[static_cast<std::size_t>(k)][cell] = *pixel < 0 ? std::uint16_t{0} : raw[*pixel];
    }
    const RangeBlock ranges = ranges_of(samples, limits);
    std::copy_n(ranges.typical_m.begin(), count, grid.depth_m.begin() + static_cast<std::ptrdiff_t>(begin));
    std::copy_n(ranges.near_m.begin(), count, grid.near_m.begin() + static_cast<std::ptrdiff_t>(begin));
    std::copy_n(ranges.far_m.begin(), count, grid.far_m.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  widen_ranges(grid);
  return grid;
}

cv::Vec3b DepthGridSampler::color_bgr(const vision::RgbdImage& image, std::size_t cell) const {
  cv::Vec3i sum(0, 0, 0);
  int count = 0;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const int pixel = pixels_[cell * kSamples + k];
    if (pixel < 0) continue;
    sum += cv::Vec3i(image.color_bgr.at<cv::Vec3b>(pixel / size_.width, pixel % size_.width));
    ++count;
  }
  return count > 0 ? cv::Vec3b(sum / count) : cv::Vec3b(0, 0, 0);
}

DepthClusters find_depth_clusters(const DepthGrid& grid, const ClusterConfig& config) {
  const auto cells = static_cast<std::size_t>(grid.shape.size());
  DisjointCells sets(cells);
  join_neighbours(grid, config, sets);

  std::vector<int> size(cells, 0);
  std::vector<int> root(cells, -1);
  for (std::size_t i = 0; i < cells; ++i) {
    if (grid.depth_m[i] <= 0) continue;
    root[i] = sets.root(static_cast<int>(i));
    ++size[static_cast<std::size_t>(root[i])];
  }
  DepthClusters clusters{grid.shape, std::vector<std::int32_t>(cells, -1), {}};
  std::vector<std::int32_t> number(cells, -1);
  for (std::size_t i = 0; i < cells; ++i) {
    if (root[i] < 0 || size[static_cast<std::size_t>(root[i])] < kMinClusterCells) continue;
    auto& label = number[static_cast<std::size_t>(root[i])];
    if (label < 0) {
      label = clusters.count();
      clusters.cells.push_back(size[static_cast<std::size_t>(root[i])]);
    }
    clusters.label[i] = label;
  }
  return clusters;
}

}  // namespace rtd::filter
