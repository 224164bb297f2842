// SPDX-FileCopyrightText: 2026 The RTD-SLAM Authors
// SPDX-License-Identifier: Apache-2.0
#include "services/evaluation/core/report/html.hpp"

#include <array>

#include "services/evaluation/core/plot/svg.hpp"

namespace rtd::eval::html {
namespace {

using plot::escape_markup;

constexpr const char* kStyle = R"css(
:root{color-scheme:light dark;--page:#f5f7f9;--panel:#fff;--line:#e2e7ec;--soft:#e8edf2;--ink:#1c2733;--muted:#64727f}
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue","DejaVu Sans",Arial,sans-serif}
main{max-width:1160px;margin:0 auto;padding:28px 24px 48px}
header{margin:0 0 20px}
h1{font-size:26px;line-height:1.25;margin:0;letter-spacing:-.01em}
header p{margin:4px 0 12px;color:var(--muted);overflow-wrap:anywhere}
section{background:var(--panel);border:1px solid var(--line);border-radius:10px;padding:18px 20px 16px;margin:0 0 18px}
h2{font-size:17px;margin:0 0 8px}
.note{color:var(--muted);font-size:13.5px;margin:-6px 0 12px;max-width:105ch}
svg{display:block;width:100%;height:auto}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(165px,1fr));gap:12px;margin:0 0 18px}
.card{background:var(--panel);border:1px solid var(--line);border-top:4px solid #9aa5b1;border-radius:10px;padding:12px 14px}
.card b{display:block;font-size:25px;line-height:1.2;font-weight:650;letter-spacing:-.01em;font-variant-numeric:tabular-nums}
.card span{display:block;font-weight:600;font-size:13.5px;margin-top:2px}
.card small{display:block;color:var(--muted);font-size:12.5px;line-height:1.4}
.good{border-top-color:#2d9c5f}.warn{border-top-color:#dd8a1d}.bad{border-top-color:#d03a3f}
.badges{display:flex;flex-wrap:wrap;gap:8px}
.badges span{background:var(--soft);border-radius:6px;padding:3px 10px;font-size:13px;overflow-wrap:anywhere}
.badges i{font-style:normal;color:var(--muted);margin-right:6px}
table{border-collapse:collapse;width:100%;font-size:13.5px;font-variant-numeric:tabular-nums}
th{color:var(--muted);font-weight:600;border-bottom:1.5px solid var(--line)}
td{border-bottom:1px solid var(--line)}
th,td{padding:6px 8px;text-align:right}th:first-child,td:first-child{text-align:left}
ul{margin:6px 0 4px;padding-left:20px}li{margin:2px 0;overflow-wrap:anywhere}
.wide{overflow-x:auto}
.columns{display:grid;grid-template-columns:minmax(0,1.75fr) minmax(0,1fr);gap:24px;align-items:start}
.gallery{display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:14px}
figure{margin:0}figure svg{border-radius:6px;background:var(--soft)}
figcaption{font-size:13px;color:var(--muted);margin-top:4px}
.strip{display:flex;gap:14px;overflow-x:auto;scroll-snap-type:x mandatory;max-width:760px;margin:0 auto;padding-bottom:8px;scrollbar-color:var(--muted) var(--soft)}
.strip figure{flex:0 0 100%;scroll-snap-align:start}
footer{color:var(--muted);font-size:13px;margin-top:8px}
@media(max-width:820px){.columns{grid-template-columns:minmax(0,1fr)}main{padding:18px 12px}section{padding:14px 12px}
.wide>svg{min-width:800px}.columns svg{min-width:560px}.columns>div{overflow-x:auto}.gallery{grid-template-columns:1fr}}
@media(max-width:820px){td,th{padding:6px 4px}}
@media(prefers-color-scheme:dark){
:root{--page:#11161c;--panel:#1a2129;--line:#303b46;--soft:#27313b;--ink:#e3e9ef;--muted:#9aa8b5}
svg [fill="#1c2733"]{fill:#e3e9ef}svg [stroke="#1c2733"]{stroke:#e3e9ef}svg [fill="#64727f"]{fill:#9aa8b5}
svg [stroke="#64727f"]{stroke:#9aa8b5}svg [stroke="#e7ebef"]{stroke:#303b46}svg [stroke="#b9c2cb"]{stroke:#55626e}
svg [fill="#ffffff"]{fill:#1a2129}svg [fill="#2367a8"]{fill:#6aa5de}svg [stroke="#2367a8"]{stroke:#6aa5de}
svg [fill="#7a4fa3"]{fill:#b48bdb}svg [stroke="#7a4fa3"]{stroke:#b48bdb}}
@media print{:root{color-scheme:light}body{background:#fff}section,.card,figure{break-inside:avoid}.strip{flex-wrap:wrap}}
)css";

constexpr std::array<const char*, 4> kToneClasses{"card", "card good", "card warn", "card bad"};  // by Tone

std::string row(const std::vector<std::string>& cells, const std::string& tag) {
  std::string text = "<tr>";
  for (const std::string& cell : cells) text += "<" + tag + ">" + escape_markup(cell) + "</" + tag + ">";
  return text + "</tr>\n";
}

std::string each_figure(const std::vector<Figure>& figures) {
  std::string text;
  for (const Figure& figure : figures) {
    text += "<figure>" + figure.markup + "<figcaption>" + escape_markup(figure.caption) + "</figcaption></figure>\n";
  }
  return text;
}

}  // namespace

std::string page(const std::string& title, const std::string& subtitle, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escape_markup(title) + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<main>\n<header>\n<h1>" +
         escape_markup(title) + "</h1>\n<p>" + escape_markup(subtitle) + "</p>\n</header>\n" + body +
         "</main>\n</body>\n</html>\n";
}

std::string section(const std::string& title, const std::string& note, const std::string& content) {
  const std::string note_markup = note.empty() ? "" : "<p class=\"note\">" + escape_markup(note) + "</p>\n";
  return "<section>\n<h2>" + escape_markup(title) + "</h2>\n" + note_markup + "<div class=\"wide\">" + content +
         "</div></section>\n";
}

std::string cards(const std::vector<Card>& cards) {
  std::string text = "<div class=\"cards\">\n";
  for (const Card& card : cards) {
    const std::string accent = card.accent.empty() ? "" : " style=\"border-top-color:" + card.accent + "\"";
    text += "<div class=\"" + std::string(kToneClasses.at(static_cast<std::size_t>(card.tone))) + "\"" + accent +
            "><b>" + escape_markup(card.value) + "</b><span>" + escape_markup(card.label) + "</span><small>" +
            escape_markup(card.detail) + "</small></div>\n";
  }
  return text + "</div>\n";
}

std::string table(const Table& table) {
  std::string text = "<table>\n<thead>" + row(table.head, "th") + "</thead>\n<tbody>\n";
  for (const auto& cells : table.rows) text += row(cells, "td");
  return text + "</tbody>\n</table>\n";
}

std::string badges(const std::vector<std::pair<std::string, std::string>>& badges) {
  std::string text = "<div style=\"margin:-8px 0 18px\"><div class=\"badges\">\n";
  for (const auto& [name, value] : badges) {
    if (!value.empty()) text += "<span><i>" + escape_markup(name) + "</i>" + escape_markup(value) + "</span>\n";
  }
  return text + "</div>\n</div>\n";
}

std::string list(const std::vector<std::string>& lines) {
  std::string text = "<ul>\n";
  for (const std::string& line : lines) text += "<li>" + escape_markup(line) + "</li>\n";
  return text + "</ul>\n";
}

std::string columns(const std::string& left, const std::string& right) {
  return "<div class=\"columns\">\n<div>" + left + "</div>\n<div>" + right + "</div>\n</div>\n";
}

std::string gallery(const std::vector<Figure>& figures) {
  return "<div class=\"gallery\">\n" + each_figure(figures) + "</div>\n";
}

std::string slider(const std::vector<Figure>& figures) {
  return "<div class=\"strip\" tabindex=\"0\">\n" + each_figure(figures) + "</div>\n";
}

}  // namespace rtd::eval::html
