// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rtd::eval::html {

/// A whole page: head with inline styles for light and dark, heading, body. Self-contained, no script.
std::string page(const std::string& title, const std::string& subtitle, const std::string& body);

/// A titled block; `note` is a line of explanation under the title. Title and note are escaped, content is markup.
std::string section(const std::string& title, const std::string& note, const std::string& content);

/// Whether a number is good or bad.
enum class Tone { kNeutral, kGood, kWarn, kBad };

/// A headline number.
struct Card {
  std::string value, label, detail;
  Tone tone = Tone::kNeutral;
  std::string accent = "";  ///< colour of its upper edge instead of the tone's
};
std::string cards(const std::vector<Card>& cards);

/// A table of text cells; the first column is left-aligned, the rest right. Everything is escaped.
struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};
std::string table(const Table& table);

/// Small labels in a row: "pace lockstep", "filter rtd", ...
std::string badges(const std::vector<std::pair<std::string, std::string>>& badges);

/// A bulleted list of escaped lines.
std::string list(const std::vector<std::string>& lines);

/// Blocks beside each other on wide screens, below each other on narrow ones.
std::string columns(const std::string& left, const std::string& right);

/// Pictures in a grid; each with a caption (escaped).
struct Figure {
  std::string markup, caption;
};
std::string gallery(const std::vector<Figure>& figures);
/// The same, one at a time, in a strip whose scroll bar goes through them.
std::string slider(const std::vector<Figure>& figures);

}  // namespace rtd::eval::html
