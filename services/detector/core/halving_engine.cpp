// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <opencv2/core.hpp>
#include <utility>

#include "services/detector/core/engine.hpp"

namespace rtd::detector {
namespace {

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

  const std::vector<RawHead>& infer(const cv::Mat& blob) override {
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
  const std::vector<RawHead>& infer_in_parts(const cv::Mat& blob) {
    logits_.assign(outputs(), {});
    heads_.assign(outputs(), {});
    for (int first = 0; first < blob.size[0]; first += most_) {
      const std::vector<RawHead>& heads = engine_->infer(part_of(blob, first, std::min(most_, blob.size[0] - first)));
      for (std::size_t i = 0; i < heads.size(); ++i) append(heads[i], i);
    }
    for (std::size_t i = 0; i < heads_.size(); ++i) heads_[i].logits = logits_[i].empty() ? nullptr : logits_[i].data();
    return heads_;
  }

  void append(const RawHead& head, std::size_t i) {
    if (head.logits == nullptr) return;
    logits_[i].insert(logits_[i].end(), head.logits, head.of(head.images));
    const int before = heads_[i].images;
    heads_[i] = head;
    heads_[i].images = before + head.images;
  }

  const std::unique_ptr<Engine> engine_;
  std::string device_;
  int most_ = 0;                            ///< images at a time; 0: any number
  std::vector<std::vector<float>> logits_;  ///< of each output
  std::vector<RawHead> heads_;
};

}  // namespace

std::unique_ptr<Engine> halve_when_full(std::unique_ptr<Engine> engine) {
  return std::make_unique<HalvingEngine>(std::move(engine));
}

}  // namespace rtd::detector
