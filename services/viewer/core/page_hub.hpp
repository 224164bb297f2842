// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "services/viewer/core/access.hpp"
#include "services/viewer/core/robot_mirror.hpp"

namespace rtd::viewer {

/// What a page wants to be sent; a hidden panel switches its part off.
struct PageOptions {
  bool image = true, mask = true, features = true, points = true, dense = false, people = true;
  bool moving = false, plan = false;  ///< the dense points of what moved; the floor plan
  bool depth = false;                 ///< a picture of the depth next to the image
  PageOptions operator|(const PageOptions& other) const {
    return {image || other.image,   mask || other.mask,   features || other.features,
            points || other.points, dense || other.dense, people || other.people,
            moving || other.moving, plan || other.plan,   depth || other.depth};
  }
  bool operator==(const PageOptions&) const = default;
  static PageOptions nothing() { return {false, false, false, false, false, false}; }
  /// No page is open: what one that opens after the end could not get any more, and the image until there is one, then
  /// for a second in five.
  static PageOptions for_later(std::int64_t now_ns, bool has_image) {
    PageOptions later = nothing();
    later.points = later.dense = later.plan = true;
    later.image = !has_image || now_ns / 1'000'000'000 % 5 == 0;
    return later;
  }
};

/// How much a page gets.
struct PageLimits {
  double bytes_per_s = 1e6;           ///< all messages
  double view_bytes_per_s = 700e3;    ///< images with their overlays
  double views_per_s = 10;            ///< images, at most
  double burst_bytes = 2e6;           ///< at once, e.g. the whole state for a new page
  double messages_per_s = 31;         ///< of poses, at most
  std::size_t most_points = 200'000;  ///< of a map; a larger map is thinned out
  std::size_t most_dense = 120'000;   ///< of a dense cloud
};

struct PageGreeting {
  std::string version, vendor;
  std::uint32_t domain = 0;
  bool control = false;         ///< commands may be called
  std::string look_token = {};  ///< for links of pages that know the other one; empty: a page needs none to look
};

class PageSession;

/// What all pages see: the mirrors of the robots. One thread.
class PageHub {
 public:
  struct Hooks {
    /// Calls a command of a robot. `answer` may be called later, by the hub's thread.
    std::function<void(const std::string& robot, const std::string& name, const std::string& argument,
                       std::function<void(CommandResult)> answer)>
        on_call;
    std::function<double()> now_ms;  ///< since 1970
  };

  PageHub(PageGreeting greeting, PageLimits limits, Hooks hooks);
  ~PageHub();

  /// A page connects. The hub outlives the session.
  std::unique_ptr<Session> open(Rights rights = Rights::kControl);
  /// The mirror of a robot; known ones keep their index. Null when there are too many.
  RobotMirror* robot(const std::string& name);
  /// What page::atlas() says.
  void set_atlas(std::string json);
  /// What any page wants of a robot; nothing without pages.
  std::optional<PageOptions> options(std::uint8_t robot) const;
  std::size_t clients() const { return sessions_.size(); }
  /// Pages that say that they can draw.
  std::size_t ready() const;

 private:
  friend class PageSession;

  const PageGreeting greeting_;
  const PageLimits limits_;
  const Hooks hooks_;
  std::vector<std::string> names_;
  RobotMirror::Message atlas_;
  std::vector<std::unique_ptr<RobotMirror>> mirrors_;
  std::set<PageSession*> sessions_;
};

}  // namespace rtd::viewer
