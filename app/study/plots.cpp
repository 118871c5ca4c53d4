#include "app/study/plots.hpp"

#include "app/study/tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia::app {
namespace {

bool varies_size(const StudyResult& result, std::size_t axis) {
  return std::any_of(result.series.begin(), result.series.end(), [&](const SizeSeries& s) { return s.axis == axis; });
}

PlotLine uncertainty_line(const ReferenceValue& reference) {
  return {reference.uncertainty, false, "uncertainty of the reference"};
}

PlotPoint point_of(const StudyResult& result, std::size_t m, const StudyRun& run) {
  PlotPoint point;
  point.y = *run.measured[m].error;
  point.marked = run.on_front[m] != 0;
  point.detail = fmt::format("{}\nerror {}\n{} {} ({} to {})\n{} unknowns", label_of(result, run), error_text(point.y),
                             cost_name(result.cost), seconds_text(run.cost.median), seconds_text(run.cost.low),
                             seconds_text(run.cost.high), run.record->dofs);
  return point;
}

}  // namespace

std::optional<std::size_t> series_axis(const StudyResult& result) {
  for (std::size_t a = 0; a < result.study.axes.size(); ++a)
    if (!result.study.axes[a].values.front().model.empty()) return a;
  for (std::size_t a = 0; a < result.study.axes.size(); ++a)
    if (!varies_size(result, a)) return a;
  return std::nullopt;
}

Plot front_plot(const StudyResult& result, const Question& question) {
  const std::size_t m = question.measure;
  Plot plot;
  plot.title = fmt::format("{}: what accuracy costs", question.name);
  plot.x_title = cost_name(result.cost) + " [s]";
  plot.y_title = fmt::format("error of {} [-]", question.name);
  plot.log_x = plot.log_y = true;
  plot.ring_name = "nothing is better and cheaper";
  const std::optional<std::size_t> axis = series_axis(result);
  const std::size_t count = axis ? result.study.axes[*axis].values.size() : 1;
  for (std::size_t s = 0; s < count; ++s) {
    PlotSeries& series = plot.series.emplace_back();
    if (axis)
      series.name = fmt::format("{} {}", result.study.axes[*axis].name, result.study.axes[*axis].values[s].label);
    // Of more axes a line would join what does not belong together.
    series.joined = result.study.axes.size() <= 2;
    for (const StudyRun& run : result.runs) {
      if (!belongs(result, question, run) || !run.measured[m].error || (axis && run.plan.at[*axis] != s)) continue;
      PlotPoint point = point_of(result, m, run);
      point.x = run.cost.median;
      point.x_low = run.cost.low;
      point.x_high = run.cost.high;
      if (point.marked) {
        std::string label;
        for (std::size_t a = 0; a < run.plan.at.size(); ++a)
          if (!axis || a != *axis)
            label += (label.empty() ? "" : ", ") + result.study.axes[a].values[run.plan.at[a]].label;
        point.label = label;
      }
      series.points.push_back(std::move(point));
    }
    std::sort(series.points.begin(), series.points.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  }
  if (question.reference.uncertainty > 0) plot.lines.push_back(uncertainty_line(question.reference));
  return plot;
}

Plot convergence_plot(const StudyResult& result, const Question& question) {
  const std::size_t m = question.measure;
  Plot plot;
  plot.title = fmt::format("{}: convergence", question.name);
  plot.y_title = fmt::format("error of {} [-]", question.name);
  plot.log_x = plot.log_y = true;
  const std::optional<std::size_t> grouped = series_axis(result);
  for (const SizeSeries& s : result.series) {
    const StudyRun& first = result.runs[s.runs.front()];
    const std::optional<std::size_t> per = result.study.measures[m].per;
    bool shown = true;
    for (std::size_t a = 0; a < first.plan.at.size(); ++a)
      shown = shown && (a == s.axis || (grouped && a == *grouped) || (per && a == *per) || first.plan.at[a] == 0);
    if (!shown) continue;
    const bool unknowns = result.runs[s.runs.front()].record->dofs != result.runs[s.runs.back()].record->dofs;
    const std::string x_title = unknowns ? "unknowns" : result.study.axes[s.axis].name;
    if (!plot.x_title.empty() && plot.x_title != x_title) continue;  // another kind of size has the axis
    plot.x_title = x_title;
    PlotSeries series;
    series.name = grouped ? fmt::format("{} {}", result.study.axes[*grouped].name,
                                        result.study.axes[*grouped].values[first.plan.at[*grouped]].label)
                          : result.study.axes[s.axis].name;
    series.joined = true;
    if (s.order[m]) series.note = fmt::format("order {:.2f}", *s.order[m]);
    for (std::size_t i = 0; i < s.runs.size(); ++i) {
      const StudyRun& run = result.runs[s.runs[i]];
      if (!belongs(result, question, run) || !run.measured[m].error) continue;
      PlotPoint point = point_of(result, m, run);
      point.marked = false;
      point.x = unknowns ? run.record->dofs : s.h[i];
      series.points.push_back(std::move(point));
    }
    if (!series.points.empty()) plot.series.push_back(std::move(series));
  }
  if (question.reference.uncertainty > 0) plot.lines.push_back(uncertainty_line(question.reference));
  return plot;
}

}  // namespace fascia::app
