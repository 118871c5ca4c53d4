#include "app/explain/report.hpp"
#include "app/explain/turns.hpp"
#include "app/results/provenance.hpp"
#include "app/study/tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numbers>

namespace fascia::app {
namespace {

/// Changes of probes below this are rounding.
constexpr double kRounding = 1e-12;

/// Width of a UTF-8 text on a terminal.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Columns as wide as their widest cell; the first one at the left, the others as `left` says.
std::string table_of(const std::vector<std::vector<std::string>>& rows, const std::vector<bool>& left) {
  std::vector<std::size_t> widths(left.size(), 0);
  for (const auto& row : rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string space(widths[c] - width_of(row[c]), ' ');
      line += (c == 0 ? "  " : "   ") + (left[c] ? row[c] + space : space + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string share_text(double part, double whole) {
  return whole > 0 ? fmt::format("{:.0f} %", 100 * part / whole) : "";
}

std::string runs_text(int n) { return n == 1 ? "one run" : fmt::format("{} runs", n); }

std::string megabytes(double bytes) { return fmt::format("{:.3g} MB", bytes / 1e6); }

/// "-31 % (-33 to -28)"
std::string ratio_text(const Ratio& r) {
  const auto percent = [](double ratio) { return 100 * (ratio - 1); };
  return fmt::format("{:+.0f} % ({:+.0f} to {:+.0f})", percent(r.median), percent(r.low), percent(r.high));
}

std::string stage_table(const Explanation& e) {
  const Stages& s = e.stages;
  const double seconds = s.start + s.setup + s.solve + s.output;
  std::vector<std::vector<std::string>> rows{{"stage", "time", "", "memory", ""}};
  const auto add = [&](const char* name, double time, const Spread* spread, double memory) {
    std::string text = seconds_text(time);
    if (spread != nullptr && spread->high > spread->low)
      text += fmt::format(" ({} to {})", seconds_text(spread->low), seconds_text(spread->high));
    rows.push_back({name, text, share_text(time, seconds), memory < 0 ? "" : megabytes(memory),
                    memory < 0 ? "" : share_text(memory, e.base.memory)});
  };
  add("start of the program", s.start, nullptr, s.memory_start);
  add("set-up", s.setup, &e.base.setup, s.memory_setup);
  add("solve", s.solve, &e.base.solve, s.memory_run);
  add("output", s.output, nullptr, -1);
  return table_of(rows, {true, false, false, false, false});
}

std::string body_table(const Explanation& e) {
  double unknowns = 0, points = 0, cells = 0;
  for (const BodyProfile& b : e.bodies) {
    unknowns += b.unknowns;
    points += static_cast<double>(b.points);
    cells += static_cast<double>(b.cells);
  }
  std::vector<std::vector<std::string>> rows{
      {"body", "model", "unknowns", "points", "cells", "time", "", "memory", "turns", "strain"}};
  for (const BodyProfile& b : e.bodies) {
    const auto count = [](double n, double all) { return fmt::format("{:.0f} ({})", n, share_text(n, all)); };
    std::vector<std::string> row{b.name, b.model, count(b.unknowns, unknowns),
                                 count(static_cast<double>(b.points), points),
                                 b.cells > 0 ? count(static_cast<double>(b.cells), cells) : ""};
    row.push_back(fmt::format("{}{:.0f} %", b.time.estimated ? "~" : "", 100 * b.time.value));
    row.push_back(b.time.estimated ? "estimate" : b.time.how);
    row.push_back(b.memory ? fmt::format("{:.0f} %", 100 * *b.memory) : "");
    row.push_back(b.motion ? fmt::format("{:.2g}°", b.motion->rotation * 180 / std::numbers::pi) : "");
    row.push_back(b.motion && b.motion->strain ? fmt::format("{:.2g} %", 100 * *b.motion->strain) : "");
    rows.push_back(std::move(row));
  }
  return table_of(rows, {true, true, false, false, false, false, true, false, false, false});
}

std::string largest_text(const Part& part) {
  const ProbeChange* largest = part.largest_change();
  if (largest == nullptr) return "no probe to compare";
  const auto gone =
      std::count_if(part.changes.begin(), part.changes.end(), [](const ProbeChange& c) { return !c.relative; });
  std::string text =
      *largest->relative > kRounding ? fmt::format("{} {}", largest->probe, error_text(*largest->relative)) : "none";
  if (gone > 0) text += fmt::format(" ({} without value)", gone);
  return text;
}

std::string part_table(const Explanation& e) {
  std::vector<std::vector<std::string>> rows{
      {"change", "solve", "iterations", "set-up", "memory", "largest change of a probe"}};
  for (const Part& part : e.parts) {
    if (!part.measured()) continue;
    rows.push_back({label_of(part.variant), ratio_text(part.solve), std::to_string(part.record->newton),
                    fmt::format("{:+.0f} %", 100 * (part.setup.median - 1)),
                    fmt::format("{:+.0f} %", 100 * (part.memory - 1)), largest_text(part)});
  }
  return rows.size() > 1 ? table_of(rows, {true, false, false, false, false, true}) : "  none\n";
}

std::string failures(const Explanation& e) {
  std::string text;
  for (const Part& part : e.parts) {
    const bool failed = part.record && !part.record->converged();
    if (!part.variant.refused.empty() || failed)
      text +=
          fmt::format("  {}: {}\n", label_of(part.variant),
                      failed ? fmt::format("{}: {}", part.record->status, part.record->reason) : part.variant.refused);
  }
  return text;
}

std::string suggestion_text(const Suggestion& s) {
  std::string text = "  " + s.text + "\n   ";
  for (const std::string& change : s.overrides) text += " --set " + quoted_for_shell(change);
  return text + "\n";
}

}  // namespace

std::string label_of(const Variant& v) {
  if (v.change.find("`" + v.part) != std::string::npos) return v.change;
  std::string plain;
  for (const char c : v.change)
    if (c != '`') plain += c;
  return fmt::format("{} {}", v.body.empty() ? v.part : "bodies." + v.body, plain);
}

std::string text_of(const Explanation& e) {
  std::string text = fmt::format("{}: {} unknowns, {} steps, {} Newton iterations, {} threads\n\n",
                                 e.scene.path.string(), e.base.dofs, e.base.steps, e.base.newton, e.base.threads);
  text += stage_table(e) + "\n" + body_table(e);
  if (std::any_of(e.bodies.begin(), e.bodies.end(), [](const BodyProfile& b) { return b.time.estimated; }))
    text += "  ~ estimate: the body's share of the points\n";
  if (!e.quick)
    text +=
        fmt::format("\nthe scene with each part and without it: one run of each, among {} of the scene as it is{}\n",
                    e.base.repeats, is_serial(e.base) ? ", by processor time" : "") +
        part_table(e);
  if (const std::string failed = failures(e); !failed.empty() && !e.quick) text += "\nwhat could not be run\n" + failed;
  text +=
      fmt::format("\nsuggestions that change no probe by more than {}{}\n", error_text(e.limit),
                  e.quick ? ", by estimates"
                          : fmt::format("; times: {} in turns with the scene as it is, twice as many where they spread",
                                        runs_text(e.turns)));
  for (const Suggestion& s : e.suggestions) text += suggestion_text(s);
  if (e.suggestions.empty()) text += "  none\n";
  if (e.together) text += suggestion_text(*e.together);
  for (const std::string& note : e.notes) text += "\n" + note;
  if (e.interrupted) text += "\ninterrupted: what was known by then";
  if (!e.notes.empty() || e.interrupted) text += "\n";
  return text;
}

}  // namespace fascia::app
