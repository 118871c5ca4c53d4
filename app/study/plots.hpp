#pragma once

#include "app/report/svg_plot.hpp"
#include "app/study/evaluation.hpp"

namespace fascia::app {

/// The axis whose values give the series of plots: models, else the first one that varies no size; none where all do.
std::optional<std::size_t> series_axis(const StudyResult& result);

/// Error of a question's runs against the cost of each run, with the front marked.
Plot front_plot(const StudyResult& result, const Question& question);

/// Error over the size that an axis varies, a series for each value of series_axis(), other axes at their
/// first values; with observed orders. Without points where nothing varies a size.
Plot convergence_plot(const StudyResult& result, const Question& question);

}  // namespace fascia::app
