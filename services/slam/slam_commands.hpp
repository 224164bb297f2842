// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "common/bus/commands.hpp"
#include "common/io/named_files.hpp"
#include "services/slam/config.hpp"
#include "services/slam/core/slam_system.hpp"
#include "services/slam/map_keeper.hpp"

namespace rtd::slam {

/// The commands slam/reset, slam/save_map, slam/load_map, slam/localize_only and slam/ask. Files are read and written
/// next to tracking; what changes the system happens between two frames.
class SlamCommands {
 public:
  /// Takes the map over in the worker's thread; the answer's text when the camera does not fit, else empty.
  using TakeMap = std::function<std::string(MapContents contents)>;
  using Forget = std::function<void()>;

  /// The others outlive this. `forget` resets the system in the worker's thread.
  /// `maps_folder`: of the maps that may be named; "": only those of `files` are saved and loaded.
  SlamCommands(bus::Bus& bus, const MapFileConfig& files, const std::string& maps_folder, SlamSystem& slam,
               MapKeeper& keeper, TakeMap take_map, Forget forget);
  /// Carries out what waits. By the worker, between frames.
  void serve() { server_.serve(); }
  void close() { server_.close(); }

 private:
  bus::CommandAnswer reset();
  bus::CommandAnswer save(const std::string& name);
  bus::CommandAnswer load(const std::string& name);
  bus::CommandAnswer localize_only(bool on);
  bus::CommandAnswer ask(const std::string& text);

  const MapFileConfig files_;
  const io::NamedFiles maps_;
  SlamSystem& slam_;
  MapKeeper& keeper_;
  const TakeMap take_map_;
  const Forget forget_;
  bus::CommandServer server_;  // last: it uses the others
};

}  // namespace rtd::slam
