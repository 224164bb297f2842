// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
/// Attacks the detector: red_detector [messages] [seed]. Hostile but well-formed frames and poses go through the edge
/// of the bus into what prepares the network's input, and hostile answers of a network into the decoder. What must
/// hold: no crash, no sanitizer report, no exception, no call of a second, bounded memory (red_watch.hpp), boxes that
/// are finite and within the frame. The preset asan-ubsan gives it its teeth. The network itself sees pixels only.
#include <cmath>
#include <memory>

#include "common/msg/transform_eigen.hpp"
#include "common/vision/rgbd_image.hpp"
#include "services/detector/core/decoder.hpp"
#include "services/detector/core/network_input.hpp"
#include "tests/fuzz/red/attack.hpp"
#include "tests/fuzz/red/red_watch.hpp"
#include "tests/fuzz/red/small_frames.hpp"

namespace rtd::detector {
namespace {

using rtd::testing::SmallFrames;

constexpr InputSize kInput{160, 128};
constexpr int kClasses = 8, kBins = 7;  // 3 (5 + classes) planes are more than classes + 4 bins

/// One head of a network's answer, of which each number is anything.
struct Answer {
  std::vector<float> logits;
  HeadLogits head;
};

class Attack {
 public:
  explicit Attack(rtd::testing::RedWatch& watch) : watch_(watch), attacker_(watch.seed()) {}

  int run() {
    while (watch_.more()) {
      if (watch_.messages() >= 300 && !settled_) {
        settled_ = true;
        watch_.settled();
      }
      step(settled_ && !attacker_.one_in(3));
    }
    return broken_ > 0 ? 1 : watch_.finish();
  }

 private:
  void step(bool hostile) {
    ++seq_;
    SmallFrames::paint(seq_, *frame_);
    if (hostile) attacker_.attack(*frame_);
    if (hostile && attacker_.one_in(4)) {
      frame_->width = static_cast<std::uint32_t>(1 + attacker_.below(attacker_.one_in(2) ? 3 : msg::kMaxFrameSide));
      frame_->height = static_cast<std::uint32_t>(1 + attacker_.below(attacker_.one_in(2) ? 3 : 160));
    }
    if (watch_.passes(*frame_)) watch_.call("frame", [&] { detect(vision::view_color(*frame_)); });
  }

  /// What Detector does around the network.
  void detect(const cv::Mat& image) {
    if (image.empty()) return;
    const Letterbox view = fit_letterbox(image.size(), kInput);
    fill_blob(image, view, kInput, PixelFormat(), blob_);
    const Answer answer = make_answer();
    check(decode_heads({answer.head}, kClasses, {}), view, image.size());
    check(decode_nanodet({{answer.logits.data(), answer.head.rows, answer.head.cols, 16, kBins}}, kClasses, {}), view,
          image.size());
    check(decode_yolox(make_numbers(kInput.width_px * kInput.height_px / 32 * (5 + kClasses)), kInput, kClasses, {}),
          view, image.size());
  }

  /// Boxes lie within the frame, whatever the network says.
  void check(const std::vector<Candidate>& found, const Letterbox& view, cv::Size frame) {
    for (const Candidate& candidate : suppress_non_maxima(found, {})) {
      const cv::Rect2f box = box_in_frame(candidate, view, frame);
      const bool inside = box.x >= 0 && box.y >= 0 && box.br().x <= static_cast<float>(frame.width) + 0.5F &&
                          box.br().y <= static_cast<float>(frame.height) + 0.5F;
      if (!inside && broken_++ == 0)
        std::fprintf(stderr, "a box of %g x %g at %g, %g is not within the frame\n", static_cast<double>(box.width),
                     static_cast<double>(box.height), static_cast<double>(box.x), static_cast<double>(box.y));
    }
  }

  Answer make_answer() {
    Answer answer;
    answer.head = {nullptr, kInput.height_px / 16, kInput.width_px / 16, {16, {{{10, 13}, {16, 30}, {33, 23}}}}};
    answer.logits = make_numbers(answer.head.rows * answer.head.cols * 3 * (5 + kClasses));
    answer.head.logits = answer.logits.data();
    return answer;
  }

  std::vector<float> make_numbers(int count) {
    std::vector<float> numbers(static_cast<std::size_t>(count));
    const double spread = attacker_.one_in(2) ? 8 : 0.5;
    for (float& number : numbers) number = static_cast<float>(attacker_.between(-spread, spread));
    for (std::uint64_t i = attacker_.below(60); i > 0; --i) attacker_.spoil(numbers[attacker_.below(numbers.size())]);
    return numbers;
  }

  rtd::testing::RedWatch& watch_;
  rtd::testing::Attacker attacker_;
  cv::Mat blob_;
  std::unique_ptr<msg::RgbdFrame> frame_ = std::make_unique<msg::RgbdFrame>();
  std::uint64_t seq_ = 0, broken_ = 0;
  bool settled_ = false;
};

}  // namespace
}  // namespace rtd::detector

int main(int argc, char** argv) {
  rtd::testing::RedWatch watch("red_detector", 10000, argc, argv);
  return rtd::detector::Attack(watch).run();
}
